//! Faults: their edits, and how they are applied.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// An entry of `mutants.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Fault {
    /// `check` and ids of cases, or `test` and the path of a test or of a module of tests.
    pub(crate) killed_by: String,
    edits: Vec<Edit>,
}

/// A text that occurs exactly once, in `file` or in the sources of all packages, and its replacement. White space is
/// not compared.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Edit {
    file: Option<PathBuf>,
    old: String,
    new: String,
}

/// Source files by their path in the repository.
pub(crate) struct Sources(BTreeMap<PathBuf, Source>);

struct Source {
    text: String,
    /// The text without white space; `places` has the position of each of its bytes in `text`.
    bare: String,
    places: Vec<usize>,
}

impl From<&str> for Source {
    fn from(text: &str) -> Self {
        let kept = text.char_indices().filter(|(_, c)| !c.is_whitespace());
        let places = kept.flat_map(|(at, c)| at..at + c.len_utf8()).collect();
        Self { text: text.to_string(), bare: bare(text), places }
    }
}

fn bare(text: &str) -> String {
    text.split_whitespace().collect()
}

impl FromIterator<(PathBuf, String)> for Sources {
    fn from_iter<T: IntoIterator<Item = (PathBuf, String)>>(files: T) -> Self {
        Self(files.into_iter().map(|(file, text)| (file, text.as_str().into())).collect())
    }
}

impl Sources {
    /// The sources of the package at `root` and of the packages in its `crates`.
    pub(crate) fn read(root: &Path) -> Self {
        let text = |file: PathBuf| (file.strip_prefix(root).unwrap().to_path_buf(), fs::read_to_string(&file).unwrap());
        packages(root).iter().flat_map(|package| source_files(&package.join("src"))).map(text).collect()
    }

    pub(crate) fn text(&self, file: &Path) -> &str {
        &self.0[file].text
    }
}

/// The folders of the package at `root` and of the packages in its `crates`.
pub(crate) fn packages(root: &Path) -> Vec<PathBuf> {
    let members = fs::read_dir(root.join("crates")).into_iter().flatten().map(|entry| entry.unwrap().path());
    std::iter::once(root.to_path_buf()).chain(members).collect()
}

/// The source files below a folder, in Rust and for devices; none if the folder does not exist.
pub(crate) fn source_files(folder: &Path) -> Vec<PathBuf> {
    let (mut files, mut folders) = (Vec::new(), vec![folder.to_path_buf()]);
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs" || extension == "cl") {
                files.push(path);
            }
        }
    }
    files
}

impl Fault {
    /// Returns the changed files with their new text.
    pub(crate) fn apply(&self, sources: &Sources) -> Result<BTreeMap<PathBuf, String>, String> {
        let mut changed: BTreeMap<PathBuf, Source> = BTreeMap::new();
        for edit in &self.edits {
            let (file, text) =
                edit.apply(sources.0.iter().map(|(file, source)| (file, changed.get(file).unwrap_or(source))))?;
            changed.insert(file, text.as_str().into());
        }
        Ok(changed.into_iter().map(|(file, source)| (file, source.text)).collect())
    }
}

impl Edit {
    fn apply<'a>(&self, sources: impl Iterator<Item = (&'a PathBuf, &'a Source)>) -> Result<(PathBuf, String), String> {
        let old = bare(&self.old);
        if old == bare(&self.new) {
            return Err(format!("`{}` is replaced by itself", self.old));
        }
        let asked = sources.filter(|(file, _)| self.file.as_ref().is_none_or(|asked| asked == *file));
        let found = |(file, source): (&'a PathBuf, &'a Source)| {
            let matches = source.bare.match_indices(&old).map(|(at, _)| at).collect::<Vec<_>>();
            matches.into_iter().map(move |at| (file, source, at))
        };
        let places: Vec<_> = asked.flat_map(found).collect();
        let [(file, source, at)] = places[..] else {
            let place = self.file.as_ref().map_or("all sources".into(), |file| file.to_string_lossy());
            return Err(format!("`{}` stands {} times in {place}", self.old, places.len()));
        };
        let (start, end) = (source.places[at], source.places[at + old.len() - 1] + 1);
        Ok((file.clone(), [&source.text[..start], &self.new, &source.text[end..]].concat()))
    }
}
