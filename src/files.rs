//! The files that a command reads and writes: no output may be an input, or another output, however the two are spelled.
//!
//! Every verb enters its files here before it does any work. Files are compared by identity ([`FileId`]), so links, upper folders and second
//! names do not hide one.

use crate::atomic_file::{check_writable, obstacle};
use crate::error::{Error, InputError, Result};
use crate::file_id::FileId;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fs;
use std::path::{Path, PathBuf};

/// What a command does with a file.
#[derive(Debug)]
enum Use {
    /// It reads the file; what that is to the user.
    Input(String),
    /// It replaces the file; the option that the user gave the file with.
    Output(String),
}

/// The files of one command.
#[derive(Debug, Default)]
pub struct Files {
    uses: HashMap<FileId, Use>,
}

impl Files {
    /// The command reads the file: `what` it is to the user, as in "the scene". One that is not there is left to the reader to report.
    /// Inputs are entered before outputs.
    pub fn reads(&mut self, what: &str, path: &Path) {
        if let Ok(id) = FileId::of(path) {
            self.uses.entry(id).or_insert_with(|| Use::Input(what.to_string()));
        }
    }

    /// The command reads a scene from these files.
    pub fn reads_scene(&mut self, files: &[PathBuf]) {
        for path in files {
            self.reads("a file of the scene", path);
        }
    }

    /// The command will write the file, which the user gave with `option`. Refuses what cannot be written, an input, and another output.
    pub fn writes(&mut self, option: &str, path: &Path) -> Result<()> {
        check_writable(option, path)?;
        self.claims(option, path)
    }

    /// As [`Files::writes`], for a file in a folder that may still have to be made.
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

    /// As [`Files::claims`], for a file that may only be there if `is_ours` says that it may be replaced.
    pub fn renews(&mut self, option: &str, path: &Path, is_ours: impl FnOnce(&Path) -> bool) -> Result<()> {
        self.claims(option, path)?;
        if path.exists() && !is_ours(path) {
            let problem = "is there already, and would be overwritten";
            return Err(InputError::new(option, path.display().to_string(), problem).allowed("another folder").into());
        }
        Ok(())
    }
}
