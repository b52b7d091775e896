//! Paths that lead nowhere or to another kind of file, and names that could control a terminal.

use super::experiment::{TINY, write_tiny};
use super::program::{finish, in_memory, pathmark};
use super::{place, refused};
use std::ffi::{OsStr, OsString};
use std::fs;
use std::os::unix::ffi::OsStringExt;

/// An existing file of zeros stands for a picture.
fn folder() -> tempfile::TempDir {
    let folder = in_memory();
    fs::write(folder.path().join("box.png"), [0x89, b'P', b'N', b'G', 0xff]).unwrap();
    folder
}

#[test]
fn paths_of_another_kind_are_the_users_mistake() {
    let folder = folder();
    let cases: [(&[&str], &[&str]); 14] = [
        (&["run", "thread-scaling", "--out", "/dev/null"], &["out = /dev/null", "a folder is needed"]),
        (
            &["image", "reference", "cornell", "--spp", "4", "--out", "/dev/null"],
            &["out = /dev/null", "a folder is needed"],
        ),
        (&["merge", "nothere", "-o", "a.pfm"], &["part = nothere", "no such file or folder"]),
        (&["merge", "nothere", "-o", "out"], &["part = nothere", "no such file or folder"]),
        (&["rank", "box.png"], &["folder = box.png", "is not a folder"]),
        (&["rank", "nothere"], &["nothere", "no such file"]),
        (&["inspect", "jobs", "box.png"], &["box.png:1:1: header", "not the first line of a trace"]),
        (&["simulate", "box.png"], &["box.png:1:1: header", "not the first line of a trace"]),
        (&["new", "scene", "a/b/c"], &["name = a/b/c.toml", "its folder does not exist"]),
        (&["new", "scene", "box.png/c"], &["name = box.png/c.toml", "not a directory"]),
        (&["new", "scene", "a/"], &["name = a/", "not the name of a file"]),
        (&["new", "scene", ".."], &["name = ..", "not the name of a file"]),
        (&["new", "experiment", "box.png"], &[]),
        (&["diff", "/dev/null", "/dev/null"], &["records = /dev/null", "not a regular file"]),
    ];
    for (arguments, said) in cases {
        println!("{arguments:?}");
        // `box.png` is a name, to which `.toml` is added.
        if said.is_empty() {
            finish(pathmark(folder.path(), arguments)).with_code(0);
        } else {
            refused(folder.path(), arguments, 2, said);
        }
    }
}

/// To open a pipe would wait for a writer, which never comes.
#[test]
fn pipes_are_refused() {
    let folder = folder();
    for name in ["pipe.toml", "pipe.csv", "pipe.film", "pipe.png"] {
        nix::unistd::mkfifo(&folder.path().join(name), nix::sys::stat::Mode::S_IRWXU).unwrap();
    }
    let cases: [&[&str]; 7] = [
        &["render", "pipe.toml"],
        &["run", "pipe.toml"],
        &["inspect", "jobs", "pipe.csv"],
        &["diff", "pipe.csv", "pipe.csv"],
        &["merge", "pipe.film", "-o", "a.pfm"],
        &["image", "compare", "pipe.film", "pipe.film"],
        &["image", "compare", "pipe.png", "pipe.png"],
    ];
    for arguments in cases {
        println!("{arguments:?}");
        refused(folder.path(), arguments, 2, &["pipe."]);
    }
}

/// The path of a picture is bytes; a scene's name is kept in rows as text.
#[test]
fn paths_need_not_be_text() {
    let folder = in_memory();
    let name = |ending: &str| OsString::from_vec([b"a\xff", ending.as_bytes()].concat());
    let render = ["render", "cornell", "--size", "4x4", "--spp", "4", "--trace"].map(OsString::from);
    let render: Vec<OsString> = render.into_iter().chain([name(".csv"), "-o".into(), name(".pfm")]).collect();
    finish(pathmark(folder.path(), &render)).with_code(0);
    finish(pathmark(folder.path(), &[OsStr::new("inspect"), OsStr::new("jobs"), &name(".csv")])).with_code(0);
    finish(pathmark(folder.path(), &[OsStr::new("image"), OsStr::new("compare"), &name(".pfm"), &name(".pfm")]))
        .with_code(0);
    for verb in [&["render"][..], &["run"], &["inspect", "bounces"]] {
        let arguments: Vec<OsString> = verb.iter().map(OsString::from).chain([name(".toml")]).collect();
        refused(folder.path(), &arguments, 2, &["argument = a\u{fffd}.toml", "is not UTF-8 text"]);
    }
    // The argument that must be text is named, not the picture before it.
    let arguments = [OsStr::new("render"), OsStr::new("-o"), &name(".pfm"), &name(".toml")];
    refused(folder.path(), &arguments, 2, &["argument = a\u{fffd}.toml: is not"]);
}

/// A byte order mark is no part of a definition: places count without it.
#[test]
fn a_byte_order_mark_is_no_part_of_a_definition() {
    let folder = in_memory();
    let wrong = TINY.replace("title = \"Tiny\"", "title = 7");
    for mark in ["", "\u{feff}"] {
        write_tiny(folder.path(), &format!("{mark}{wrong}"));
        let message = refused(folder.path(), &["run", "tiny.toml"], 2, &["title = 7"]);
        assert_eq!(place(&message, "tiny.toml"), Some((1, 9)), "{message}");
        fs::write(folder.path().join("a.toml"), format!("{mark}base = \"nowhere\"\nabout = \"a\"\n")).unwrap();
        let message = refused(folder.path(), &["render", "a.toml"], 2, &["base = nowhere"]);
        assert_eq!(place(&message, "a.toml"), Some((1, 9)), "{message}");
    }
}

/// Values, keys and names of files reach the terminal escaped, in errors and in remarks.
#[test]
fn control_characters_are_escaped() {
    let folder = in_memory();
    let red = "\\u001b[31mred\\u0007";
    let scene = |more: &str| format!("about = 'a'\nbase = 'cornell'\n{more}\n");
    let quad = "{ quad = { corners = [[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [9.0, 9.0, 4.0], [0.0, 9.0, 0.0]] } }";
    let object = format!("[[objects]]\nname = \"{red}\"\nmaterial = {{ mirror = {{ albedo = [1.0, 1.0, 1.0] }} }}\n");
    let cases = [
        (scene(&format!("estimator = \"{red}\"")), 2),
        (scene(&format!("without = [\"{red}\\n\"]")), 2),
        (scene(&format!("\"{red}\" = 1")), 2),
        (scene(&object), 2),
        (scene(&format!("{object}shape = {{ mesh = {{ file = \"{red}.obj\" }} }}")), 2),
        (scene(&format!("{object}shape = {quad}")), 0),
    ];
    for (text, code) in cases {
        fs::write(folder.path().join("a.toml"), &text).unwrap();
        let arguments = ["render", "a.toml", "--size", "4x4", "--spp", "4", "-o", "a.png"];
        let finished = finish(pathmark(folder.path(), &arguments)).with_code(code);
        assert!(finished.err.contains("red") && finished.err.contains("1b"), "{text}\n{}", finished.err);
        assert!(!finished.err.contains(|c: char| c.is_control() && c != '\n'), "{:?}", finished.err);
    }
    let path = "\u{1b}[2J.toml";
    let message = refused(folder.path(), &["render", path], 2, &["\\u{1b}[2J.toml"]);
    assert!(!message.contains('\u{1b}'), "{message:?}");
}
