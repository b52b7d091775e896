//! The files that a command reads and writes: no output may be an input or another output, under any spelling of their
//! paths.
//!
//! Every verb registers its files here before it does any work. Files are compared by identity ([`FileId`]), so links,
//! parent folders and second names are recognised.

use crate::atomic_file::{check_writable, obstacle};
use crate::error::{Error, InputError, Result};
use crate::file_id::FileId;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fs;
use std::path::{Path, PathBuf};

/// Creates a folder that the user gave as `field`, with its parents; nothing happens if it exists.
pub fn create_folder(field: &str, folder: &Path) -> Result<()> {
    let is_file = folder.ancestors().any(|part| part.exists() && !part.is_dir());
    fs::create_dir_all(folder).map_err(|e| {
        if is_file {
            let problem = "is a file or lies in one; a folder is needed";
            return InputError::new(field, folder.display().to_string(), problem).into();
        }
        Error::system("creating", folder, e)
    })
}

/// The paths of a folder's files and folders, sorted.
pub fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let system = |e| Error::system("reading", folder, e);
    let paths = fs::read_dir(folder).map_err(system)?.map(|entry| Ok(entry.map_err(system)?.path()));
    let mut paths = paths.collect::<Result<Vec<PathBuf>>>()?;
    paths.sort();
    Ok(paths)
}

#[derive(Debug)]
enum Use {
    /// The command reads the file, which the user knows by this description.
    Input(String),
    /// The command replaces the file, which the user gave with this option.
    Output(String),
}

#[derive(Debug, Default)]
pub struct Files {
    uses: HashMap<FileId, Use>,
}

impl Files {
    /// Registers an input. `what` describes it to the user, as in "the scene". A missing file is left to its reader to
    /// report. Inputs are registered before outputs.
    pub fn reads(&mut self, what: &str, path: &Path) {
        if let Ok(id) = FileId::of(path) {
            self.uses.entry(id).or_insert_with(|| Use::Input(what.to_string()));
        }
    }

    pub fn reads_scene(&mut self, files: &[PathBuf]) {
        for path in files {
            self.reads("a file of the scene", path);
        }
    }

    /// Registers an output, which the user gave with `option`. Refuses a file that cannot be written, an input, and
    /// another output.
    pub fn writes(&mut self, option: &str, path: &Path) -> Result<()> {
        check_writable(option, path)?;
        self.claims(option, path)
    }

    /// Like [`Files::writes`], for a file in a folder that may not exist yet.
    pub fn claims(&mut self, option: &str, path: &Path) -> Result<()> {
        let refuse = |problem: &str| Error::from(InputError::new(option, path.display().to_string(), problem));
        if let Some(problem) = fs::metadata(path).ok().as_ref().and_then(obstacle) {
            return Err(refuse(problem));
        }
        let id = FileId::of(path).map_err(|e| Error::system("looking for", path, e))?;
        match self.uses.entry(id) {
            Entry::Vacant(free) => {
                free.insert(Use::Output(option.to_string()));
                Ok(())
            }
            Entry::Occupied(taken) => Err(refuse(&match taken.get() {
                Use::Input(what) => format!("is {what}, which would be overwritten"),
                Use::Output(other) => format!("is also the file of `{other}`"),
            })),
        }
    }

    /// Like [`Files::claims`], but refuses an existing file unless `is_ours` allows its replacement.
    pub fn renews(&mut self, option: &str, path: &Path, is_ours: impl FnOnce(&Path) -> bool) -> Result<()> {
        self.claims(option, path)?;
        if path.exists() && !is_ours(path) {
            let problem = "already exists and would be overwritten";
            return Err(InputError::new(option, path.display().to_string(), problem).allowed("another folder").into());
        }
        Ok(())
    }
}
