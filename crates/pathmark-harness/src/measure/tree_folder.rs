//! The folder of `--cache`: hierarchies of large scenes, one file each.

use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::file_id::folder_of;
use crate::scene::TreeStore;
use std::fs::{self, File};
use std::io::{self, BufReader, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

/// A folder of hierarchies.
#[derive(Debug)]
pub(super) struct TreeFolder(PathBuf);

/// Refuses a path that is no folder and cannot become one. Creates nothing.
pub fn check_cache(folder: &Path) -> Result<()> {
    let refuse = |problem: &str| Err(InputError::new("cache", folder.display().to_string(), problem).into());
    match fs::metadata(folder) {
        Ok(found) if found.is_dir() => Ok(()),
        Ok(_) => refuse("is not a folder"),
        Err(e) => match e.kind() {
            ErrorKind::NotFound if folder_of(folder).is_dir() => Ok(()),
            ErrorKind::NotFound => refuse("its parent folder does not exist"),
            ErrorKind::NotADirectory => refuse("a part of the path is not a folder"),
            ErrorKind::InvalidFilename => refuse("the name is too long"),
            ErrorKind::InvalidInput => refuse("the name contains a zero byte"),
            _ => Err(Error::system("looking for", folder, e)),
        },
    }
}

impl TreeFolder {
    /// Checks the folder, which is created with its first file.
    pub(super) fn new(folder: &Path) -> Result<Self> {
        check_cache(folder)?;
        Ok(Self(folder.to_path_buf()))
    }

    fn file(&self, key: &str) -> PathBuf {
        self.0.join(format!("{key}.tree"))
    }
}

impl TreeStore for TreeFolder {
    fn find(&self, key: &str, read: &mut dyn FnMut(&mut dyn Read) -> io::Result<()>) -> Result<bool> {
        let path = self.file(key);
        let damaged = |problem: &str| {
            let problem = format!("is damaged: {problem}; delete the file to build its hierarchy again");
            Error::from(InputError::new("cache", path.display().to_string(), problem))
        };
        match fs::metadata(&path) {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(false),
            Ok(found) if !found.is_file() => return Err(damaged("it is not a regular file")),
            _ => {}
        }
        let found = File::open(&path).and_then(|file| read(&mut BufReader::new(file)));
        found.map(|()| true).map_err(|e| match e.kind() {
            ErrorKind::InvalidData => damaged(&e.to_string()),
            ErrorKind::UnexpectedEof => damaged("it ends too soon"),
            _ => Error::system("reading", &path, e),
        })
    }

    fn keep(&self, key: &str, write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> Result<()> {
        match fs::create_dir(&self.0) {
            Err(e) if e.kind() != ErrorKind::AlreadyExists => return Err(Error::system("making", &self.0, e)),
            _ => {}
        }
        atomic_file::write(&self.file(key), write)
    }
}
