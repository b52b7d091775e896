//! Locks against a second process that would write the same file or folder.
//!
//! The system lifts a lock when its process ends, however it ends: what a killed one leaves behind is a lock file that locks nothing.

use crate::error::{Error, InputError, Result};
use std::fs::{self, File, Metadata, OpenOptions, TryLockError};
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

/// A process that was killed may have had a child between its fork and its exec, which holds the lock until then.
const PATIENCE: Duration = Duration::from_secs(1);
const PAUSE: Duration = Duration::from_millis(50);

/// Locks an open file; whether it could be locked and `path` still leads to it. A file that has been replaced or removed while we waited is
/// nobody's any more.
pub fn try_lock(file: &File, path: &Path) -> io::Result<bool> {
    let mut waited = Duration::ZERO;
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(is_still_there(file, path)),
            Err(TryLockError::Error(e)) => return Err(e),
            Err(TryLockError::WouldBlock) if waited >= PATIENCE => return Ok(false),
            Err(TryLockError::WouldBlock) => thread::sleep(PAUSE),
        }
        waited += PAUSE;
    }
}

/// Whether the path still leads to the open file.
fn is_still_there(file: &File, path: &Path) -> bool {
    let same = |a: Metadata, b: Metadata| a.dev() == b.dev() && a.ino() == b.ino();
    file.metadata().and_then(|open| Ok(same(open, fs::metadata(path)?))).unwrap_or(false)
}

/// A lock file of its own, for what is replaced by renames or is a folder. It is removed when this is dropped.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    /// Locked as long as it is open.
    _file: File,
}

impl Lock {
    /// Locks the file `path`, which is made if need be. `field` and `of` say in an error what it is that another process is writing.
    pub fn new(path: &Path, field: &str, of: &Path) -> Result<Self> {
        let open = || OpenOptions::new().write(true).create(true).truncate(false).open(path);
        // Whoever held it has removed it while we waited: once more, with a file that has a name.
        for _ in 0..2 {
            let file = open().map_err(|e| Error::system("locking", path, e))?;
            if try_lock(&file, path).map_err(|e| Error::system("locking", path, e))? {
                return Ok(Self { path: path.to_path_buf(), _file: file });
            }
        }
        let problem = "is being written by another process";
        Err(InputError::new(field, of.display().to_string(), problem)
            .allowed("another name, or when it is done")
            .into())
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While it is still locked, so that nobody can have locked it in between. If it stays, it locks nothing.
        fs::remove_file(&self.path).ok();
    }
}
