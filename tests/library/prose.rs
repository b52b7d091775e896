//! Plain technical English: phrases that readers stumbled over do not come back.

use std::fs;
use std::path::{Path, PathBuf};

/// Phrases that a review found, each in two halves so that this file does not hold them.
const STUMBLED_OVER: &[(&str, &str)] = &[
    ("to the last bit, under ", "every strategy"),
    ("is the other scene with what ", "the file changes"),
    ("so falls on all ", "cells alike"),
    ("is as much larger as ", "rounding"),
    ("is unknown ", "to it"),
    ("No look knows ", "light"),
    ("where something simpler would do on ", "easy inputs"),
    ("belongs ", "into"),
    ("What finds the ", "nearest surface"),
    ("How chance ", "ends paths"),
    ("can be ", "no goal"),
    ("is no ", "size"),
    ("is nothing that this ", "processor has"),
    ("has workers or times that ", "cannot be"),
    ("are_asked", "_for"),
    ("have_a", "_goal"),
    ("struct ", "Course"),
];

const FOLDERS: &[&str] = &["src", "crates", "tests", "benches", "examples", "exercises", "experiments", "docs"];
const FILES: &[&str] =
    &["README.md", "METHODOLOGY.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "results/README.md"];
const ENDINGS: &[&str] = &["rs", "toml", "md", "js", "css"];

fn texts(path: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(path).unwrap().map(Result::unwrap) {
        let path = entry.path();
        // Build targets of crates with their own folder are not part of the project.
        if path.is_dir() && !path.ends_with("target") {
            texts(&path, found);
        } else if path.extension().is_some_and(|ending| ENDINGS.iter().any(|own| ending == *own)) {
            found.push(path);
        }
    }
}

#[test]
fn phrases_that_readers_stumbled_over_do_not_come_back() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files: Vec<PathBuf> = FILES.iter().map(|file| root.join(file)).collect();
    for folder in FOLDERS {
        texts(&root.join(folder), &mut files);
    }
    assert!(files.len() > 500, "{} files", files.len());
    let mut found = Vec::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        for (first, second) in STUMBLED_OVER {
            let phrase = format!("{first}{second}");
            found.extend(text.contains(&phrase).then(|| format!("{}: {phrase}", file.display())));
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// The comment in a line of Rust.
fn comment(line: &str) -> Option<&str> {
    line.split_once("// ").or_else(|| line.split_once("//! ")).map(|(_, comment)| comment)
}

/// Whether a sentence in the text begins with a clause that stands for an unnamed subject.
fn begins_without_a_subject(text: &str) -> bool {
    let starts = text.split(". ").chain(text.split(": "));
    !text.contains('?') && starts.into_iter().any(|sentence| sentence.starts_with("What "))
}

#[test]
fn comments_name_their_subject() {
    assert!(begins_without_a_subject("Boxes come first. What is left comes last."));
    assert!(!begins_without_a_subject("Boxes come first, the rest comes last. What is a box?"));
    let mut files = Vec::new();
    for folder in ["src", "crates", "tests", "benches", "examples"] {
        texts(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut files);
    }
    files.retain(|file| file.extension().is_some_and(|ending| ending == "rs"));
    let mut found = Vec::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let lines = text.lines().filter_map(comment).filter(|comment| begins_without_a_subject(comment));
        found.extend(lines.map(|line| format!("{}: {line}", file.display())));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}
