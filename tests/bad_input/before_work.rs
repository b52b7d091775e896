//! Input that is refused before any work: each of these commands would otherwise render for hours or read without end.

use super::experiment::{TINY, write_tiny};
use super::program::{finish, in_memory, pathmark};
use super::refused;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::os::unix::ffi::OsStringExt;
use std::process::Command;

/// Takes hours.
const LONG: [&str; 4] = ["render", "cornell", "--spp", "4000000"];
/// A reference that takes hours.
const REFERENCE: &str = "[reference]\nestimator = \"bsdf\"\n\n[quick]\nreference-spp = 16000000\n";
const RUN: [&str; 4] = ["run", "tiny.toml", "--out", "out"];

#[test]
fn a_picture_of_a_size_that_its_format_lacks() {
    let folder = in_memory();
    let arguments = [&LONG[..], &["--size", "32768x8", "-o", "a.hdr"]].concat();
    refused(folder.path(), &arguments, 2, &["size = 32768x8", "hdr"]);
}

/// A scene's name is part of the names of references, images and traces.
#[test]
fn a_name_too_long_for_the_files_to_come() {
    let folder = in_memory();
    let scene = format!("{}.toml", "x".repeat(220));
    fs::write(folder.path().join(&scene), "about = 'a test'\nbase = 'cornell'\n").unwrap();
    let reference = ["image", "reference", &scene, "--spp", "16000000", "--out", "."];
    refused(folder.path(), &reference, 2, &["xxx", "up to 255 bytes"]);
    for text in [
        TINY.replace("[quick]\n", REFERENCE),
        TINY.replace("[matrix]", "keep = [\"images\"]\n\n[matrix]").replace("spp = [4]", "spp = [16000000]"),
        TINY.replace("[matrix]", "keep = [\"traces\"]\n\n[matrix]").replace("spp = [4]", "spp = [16000000]"),
    ] {
        let folder = in_memory();
        fs::write(folder.path().join(&scene), "about = 'a test'\nbase = 'cornell'\n").unwrap();
        write_tiny(folder.path(), &text.replace("\"cornell\"", &format!("\"{scene}\"")));
        refused(folder.path(), &RUN, 2, &["xxx", "up to 255 bytes"]);
    }
}

/// The cells' processes receive the output folder as JSON.
#[test]
fn a_folder_whose_name_is_no_text() {
    let folder = in_memory();
    write_tiny(folder.path(), &TINY.replace("[quick]\n", REFERENCE));
    let out = OsString::from_vec(b"out-\xff".to_vec());
    let arguments = [OsStr::new("run"), OsStr::new("tiny.toml"), OsStr::new("--out"), &out];
    refused(folder.path(), &arguments, 2, &["out = out-", "UTF-8"]);
}

#[test]
fn a_curve_that_cannot_be_rendered_in_rounds() {
    let folder = in_memory();
    let text = TINY.replace("[matrix]\n", "[matrix]\ncurve = true\nclamp = [\"subpixel\"]\n");
    write_tiny(folder.path(), &text.replace("[quick]\n", REFERENCE));
    refused(folder.path(), &RUN, 2, &["tiny.toml:", "clamp", "subpixel", "rounds"]);
}

/// Two programs with one name would write rows that cannot be told apart.
#[test]
fn two_other_programs_of_one_name() {
    let folder = in_memory();
    let external = |program: &str| {
        let command = format!("command = [\"{program}\", \"{{out}}\", \"{{spp}}\", \"{{seed}}\"]\n");
        format!("[[external]]\nname = \"other\"\nscene = \"cornell\"\nspp = [8]\nseed = [3]\n{command}")
    };
    let text = TINY.replace("[quick]\n", &format!("{}{}{REFERENCE}", external("a"), external("b")));
    write_tiny(folder.path(), &text);
    refused(folder.path(), &RUN, 2, &["tiny.toml:", "name = other"]);
}

/// Files that never end and paths that are no files, under a memory limit that an unbounded reader would reach.
#[test]
fn files_without_an_end() {
    let folder = in_memory();
    fs::write(folder.path().join("zero.toml"), "about = 'a test'\nbase = '/dev/zero'\n").unwrap();
    fs::write(folder.path().join("nul.toml"), "about = 'a test'\nbase = \"a\\u0000.toml\"\n").unwrap();
    let mesh = |file: &str| {
        let shape = format!("{{ mesh = {{ file = \"{file}\" }} }}");
        let material = "{ diffuse = { albedo = [0.5, 0.5, 0.5] } }";
        format!("about = 'a test'\nbase = 'cornell'\n[[objects]]\nname = 'm'\nshape = {shape}\nmaterial = {material}\n")
    };
    fs::write(folder.path().join("mesh.toml"), mesh("/dev/zero")).unwrap();
    fs::write(folder.path().join("nul-mesh.toml"), mesh("a\\u0000.obj")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", folder.path().join("zero.film")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", folder.path().join("zero.png")).unwrap();
    let checkpoint = [&LONG[..], &["--checkpoint", "zero.film"]].concat();
    let cases: [(&[&str], &[&str]); 12] = [
        (&["inspect", "jobs", "/dev/zero"], &["/dev/zero", "byte 0 is zero"]),
        (&["inspect", "jobs", "."], &["directory"]),
        (&["simulate", "/dev/zero", "--out", "new"], &["/dev/zero", "byte 0 is zero"]),
        (&["render", "/dev/zero"], &["/dev/zero", "zero"]),
        (&["render", "zero.toml"], &["zero.toml:2:", "base = /dev/zero", "byte 0 is zero"]),
        (&["render", "nul.toml"], &["nul.toml:2:", "base", "zero byte"]),
        (&["render", "mesh.toml"], &["mesh.toml:4:", "/dev/zero", "byte 0 is zero"]),
        (&["render", "nul-mesh.toml"], &["nul-mesh.toml:4:", "zero byte"]),
        (&["run", "/dev/../dev/zero.toml"], &["no such file"]),
        (&["image", "compare", "zero.png", "zero.png"], &["zero.png", "regular file"]),
        (&["image", "compare", "zero.film", "zero.film"], &["zero.film"]),
        (&checkpoint, &["zero.film", "regular file"]),
    ];
    for (arguments, said) in cases {
        println!("{arguments:?}");
        refused(folder.path(), arguments, 2, said);
    }
}

/// Help that cannot be written is a failure like any other output; a reader that stops early causes none.
#[test]
fn help_onto_a_full_disk() {
    let folder = in_memory();
    for arguments in [&["--help"][..], &["--version"], &["render", "--help"], &["list"]] {
        let mut command: Command = pathmark(folder.path(), arguments);
        command.stdout(fs::File::options().write(true).open("/dev/full").unwrap());
        let finished = finish(command).with_code(3);
        assert!(finished.err.contains("writing standard output"), "{arguments:?}: {}", finished.err);
        assert!(!finish(pathmark(folder.path(), arguments)).with_code(0).out.is_empty());
    }
}
