//! The command line works as its help says: every name that `list` prints runs as it is, and verbs read each other's
//! files.

mod files;
mod machine;
mod names;
mod rounds;
mod scenes;
mod schedules;
mod selftest;
mod shards;

use crate::experiment::{TINY, write_tiny};
use crate::program::{Finished, finish, in_memory, pathmark};
use serde_json::Value;
use std::fs;
use std::path::Path;

fn run(folder: &Path, arguments: &[&str]) -> Finished {
    finish(pathmark(folder, arguments)).with_code(0)
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error} in {text}"))
}

/// The names that `list KIND` prints.
fn names(kind: &str) -> Vec<String> {
    let folder = in_memory();
    let listed = json(&run(folder.path(), &["list", kind, "--json"]).out);
    let items = listed.as_array().unwrap_or_else(|| panic!("{kind} is no array"));
    let text = |item: &Value, key: &str| item[key].as_str().filter(|text| !text.is_empty()).map(str::to_string);
    let name = |item| text(item, "about").and(text(item, "name")).unwrap_or_else(|| panic!("{kind}: {item}"));
    items.iter().map(name).collect()
}

/// The JSON record of a tiny render with `options`.
fn record(folder: &Path, scene: &str, options: &[&str]) -> Value {
    let base = ["render", scene, "--size", "24x16", "--spp", "4", "--json"];
    let finished = run(folder, &[base.as_slice(), options].concat());
    assert_eq!(finished.out.trim_end().lines().count(), 1, "one object on one line: {}", finished.out);
    json(&finished.out)
}

#[test]
fn quiet_is_quiet_and_talk_goes_to_stderr() {
    let folder = in_memory();
    write_tiny(folder.path(), TINY);
    let render = ["render", "cornell", "--size", "8x8", "--spp", "4"];
    let sweep = ["run", "tiny.toml", "--out", "out"];
    let reference = ["image", "reference", "cornell", "--size", "8x8", "--spp", "4"];
    for arguments in [render.as_slice(), &sweep, &reference] {
        let finished = run(folder.path(), &[arguments, &["--quiet"]].concat());
        assert_eq!(finished.err, "", "{arguments:?}");
        assert_ne!(finished.out, "", "{arguments:?}");
    }
    // Without a given name, the image is named after its scene.
    assert!(folder.path().join("cornell.png").is_file());
    fs::remove_dir_all(folder.path().join("out")).unwrap();
    let finished = run(folder.path(), &sweep);
    assert!(finished.err.contains("tiny") && finished.out.lines().count() == 1, "{}{}", finished.err, finished.out);
}

/// The first line of the help is about the program, not about one of its crates.
#[test]
fn the_help_begins_with_the_program() {
    let folder = in_memory();
    let help = run(folder.path(), &["--help"]).out;
    assert!(help.starts_with("A laboratory for scheduling unequal work on many cores"), "{help}");
}

/// A script for each shell names the verbs, and a manual page has a head and the options.
#[test]
fn completions_and_manual_pages_know_verbs_and_options() {
    let folder = in_memory();
    for shell in ["bash", "zsh", "fish"] {
        let script = run(folder.path(), &["shell", "completions", shell]).out;
        assert!(
            ["reproduce", "thread-scaling", "estimator"].iter().filter(|word| script.contains(**word)).count() >= 2
        );
    }
    let page = run(folder.path(), &["shell", "man"]).out;
    assert!(
        page.contains(".TH pathmark") && page.contains("reproduce") && !page.contains("One cell of a sweep"),
        "{page}"
    );
    let page = run(folder.path(), &["shell", "man", "render"]).out;
    assert!(page.contains("pathmark render") && page.contains("\\-\\-spp"), "{page}");
    let refused = finish(pathmark(folder.path(), &["shell", "man", "rendr"])).with_code(2);
    assert!(refused.err.contains("did you mean render?"), "{}", refused.err);
}
