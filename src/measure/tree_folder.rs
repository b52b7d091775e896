//! The folder of `--cache`: hierarchies of large scenes, a file for each.

use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::scene::TreeStore;
use std::fs::{self, File};
use std::io::{self, BufReader, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

/// A folder of trees.
#[derive(Debug)]
pub(super) struct TreeFolder(PathBuf);

impl TreeFolder {
    /// Makes the folder if it is not there. Refuses one into which no file can be written.
    pub(super) fn open(folder: &Path) -> Result<Self> {
        if fs::metadata(folder).is_ok_and(|found| !found.is_dir()) {
            return Err(InputError::new("cache", folder.display().to_string(), "is not a folder").into());
        }
        fs::create_dir_all(folder).map_err(|e| Error::system("making", folder, e))?;
        let folder = Self(folder.to_path_buf());
        atomic_file::check_writable("cache", &folder.file("key"))?;
        Ok(folder)
    }

    fn file(&self, key: &str) -> PathBuf {
        self.0.join(format!("{key}.tree"))
    }
}

impl TreeStore for TreeFolder {
    fn find(&self, key: &str, read: &mut dyn FnMut(&mut dyn Read) -> io::Result<()>) -> Result<bool> {
        let path = self.file(key);
        let file = match File::open(&path) {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(false),
            other => other,
        };
        let found = file.and_then(|file| read(&mut BufReader::new(file)));
        found.map(|()| true).map_err(|e| Error::system("reading", &path, e))
    }

    fn keep(&self, key: &str, write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> Result<()> {
        atomic_file::write(&self.file(key), write)
    }
}
