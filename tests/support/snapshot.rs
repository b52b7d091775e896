//! The contents of a folder, to prove that a refused command changed none of it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Paths below a folder; `None` for anything but a regular file.
pub(crate) type Snapshot = BTreeMap<PathBuf, Option<Vec<u8>>>;

/// Names and contents of all files below `folder`.
pub(crate) fn snapshot(folder: &Path) -> Snapshot {
    let mut found = Snapshot::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next).expect("a folder can be listed") {
            let entry = entry.expect("an entry can be read");
            let kind = entry.file_type().expect("an entry has a type");
            if kind.is_dir() {
                folders.push(entry.path());
            }
            let content = kind.is_file().then(|| fs::read(entry.path()).expect("a file can be read"));
            found.insert(entry.path(), content);
        }
    }
    found
}

/// Asserts that no file was added, removed or changed. Prints the paths rather than their bytes.
pub(crate) fn assert_untouched(before: &Snapshot, after: &Snapshot) {
    let differs = |path: &&PathBuf| before.get(*path) != after.get(*path);
    let changed: Vec<&PathBuf> = before.keys().chain(after.keys()).filter(differs).collect();
    assert!(changed.is_empty(), "touched: {changed:?}");
}
