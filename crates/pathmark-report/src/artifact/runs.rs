//! The folders of rows that an artifact takes, and their files in it.

use crate::claims::Answer;
use crate::error::{InputError, Result};
use crate::experiment::{DOCTOR, MACHINE, has_records, records_path};
use crate::files::entries;
use crate::lab::Lab;
use crate::results::Results;
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// Files beside rows that explain them.
const BESIDE: [&str; 2] = [MACHINE, "experiment.toml"];

/// A folder of results.
pub(super) struct Run {
    /// Its name in the archive.
    pub(super) name: String,
    pub(super) folder: PathBuf,
    /// The files that the archive takes, by their paths in the folder.
    pub(super) files: BTreeSet<PathBuf>,
    pub(super) has_experiments: bool,
}

impl Run {
    fn of(name: String, folder: &Path) -> Result<Self> {
        let refused = |problem: &str| InputError::new("folder", folder.display().to_string(), problem);
        if !folder.is_dir() {
            return Err(refused("there is no such folder").into());
        }
        if has_records(folder) {
            let above = folder.parent().unwrap_or(folder).display().to_string();
            return Err(refused("is the folder of one experiment")
                .allowed(format!("the folder above it, {above}"))
                .into());
        }
        let experiments = experiments_in(folder)?;
        let has_experiments = !experiments.is_empty();
        let mut run = Self { name, folder: folder.to_path_buf(), files: BTreeSet::new(), has_experiments };
        for experiment in experiments {
            run.take(&records_path(&experiment))?;
        }
        if folder.join(DOCTOR).is_file() {
            run.files.insert(PathBuf::from(DOCTOR));
        }
        Ok(run)
    }

    /// Takes a file of the folder, and the files that explain it.
    fn take(&mut self, file: &Path) -> Result<()> {
        let own = file.strip_prefix(&self.folder).ok().and_then(plain).ok_or_else(|| outside(file))?;
        let beside = BESIDE.map(|name| own.with_file_name(name));
        self.files.extend(beside.into_iter().filter(|path| self.folder.join(path).is_file()));
        self.files.insert(own);
        Ok(())
    }
}

fn outside(file: &Path) -> InputError {
    let problem = "lies outside of the folders of rows, so the archive cannot take it";
    InputError::new("file", file.display().to_string(), problem)
}

/// A relative path without steps to parents; `None` for any other path.
pub(super) fn plain(path: &Path) -> Option<PathBuf> {
    let kept = path.components().filter(|part| *part != Component::CurDir);
    kept.map(|part| matches!(part, Component::Normal(_)).then_some(part)).collect()
}

/// The folders in a folder, sorted.
pub(super) fn folders_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = entries(folder)?;
    found.retain(|path| path.is_dir());
    Ok(found)
}

/// The experiments in a folder of results.
pub(super) fn experiments_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = folders_in(folder)?;
    found.retain(|path| has_records(path));
    Ok(found)
}

/// The folders of rows, each once.
pub(super) fn runs_of(folders: &[PathBuf]) -> Result<Vec<Run>> {
    let (mut seen, mut names) = (BTreeSet::new(), BTreeSet::new());
    let mut runs = Vec::new();
    for folder in folders {
        let complete = folder.canonicalize().unwrap_or_else(|_| folder.clone());
        if seen.insert(complete.clone()) {
            let name = simple(&complete.file_name().unwrap_or_default().to_string_lossy());
            let others = (2..).map(|number| format!("{name}-{number}"));
            let free = std::iter::once(name.clone()).chain(others).find(|name| names.insert(name.clone()));
            runs.push(Run::of(free.unwrap_or(name), folder)?);
        }
    }
    Ok(runs)
}

/// A name that needs no quotes anywhere.
fn simple(name: &str) -> String {
    let keep = |char: char| if char.is_ascii_alphanumeric() || "-_".contains(char) { char } else { '-' };
    let name: String = name.chars().map(keep).collect();
    if name.trim_matches('-').is_empty() { "rows".to_string() } else { name }
}

/// Adds the tables that answer claims, and the files beside rows from which forecasts are simulated.
pub(super) fn add_evidence(lab: &Arc<Lab>, runs: &mut [Run], answers: &[Answer<'_>]) -> Result<()> {
    for answer in answers {
        for source in &answer.sources {
            // A folder of rows may lie in another one.
            let owners = runs.iter_mut().filter(|run| source.starts_with(&run.folder));
            let run = owners.max_by_key(|run| run.folder.components().count()).ok_or_else(|| outside(source))?;
            run.take(source)?;
            if let Some(folder) = source.parent().filter(|_| answer.is_of_forecast()) {
                for file in Results::open(lab, folder)?.files_of_forecasts() {
                    run.take(&file)?;
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_that_lead_out_are_not_plain() {
        assert_eq!(plain(Path::new("./a/./b")), Some(PathBuf::from("a/b")));
        assert_eq!((plain(Path::new("a/../b")), plain(Path::new("/a"))), (None, None));
    }

    #[test]
    fn names_are_simple_and_unique() {
        let folder = tempfile::tempdir().unwrap();
        let paths = ["x/out", "y/out", "x/my rows", "x/..."].map(|name| folder.path().join(name));
        for path in &paths {
            std::fs::create_dir_all(path).unwrap();
        }
        let runs = runs_of(&[paths.to_vec(), vec![folder.path().join("x/../x/out")]].concat()).unwrap();
        let names: Vec<&str> = runs.iter().map(|run| run.name.as_str()).collect();
        assert_eq!(names, ["out", "out-2", "my-rows", "rows"]);
    }
}
