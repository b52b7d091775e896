//! Locks that keep a second process from writing the same file or folder.
//!
//! The system releases a lock when its process ends in any way, so a killed process leaves a lock file that locks
//! nothing. Lock files have names that no other program uses, and are empty. Any other file of that name belongs to the
//! user and stays.

use crate::digest;
use crate::error::{Error, InputError, Result};
use crate::file_id::{folder_of, followed};
use std::fs::{self, File, Metadata, OpenOptions, TryLockError};
use std::io;
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

/// Longest wait for a lock. A killed process may have had a child between its fork and its exec, which holds the lock
/// until then.
const PATIENCE: Duration = Duration::from_secs(1);
const PAUSE: Duration = Duration::from_millis(50);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    Alone,
    Shared,
}

/// Locks an open file; returns whether it could be locked and `path` still leads to it. A lock on a file that was
/// replaced or removed while we waited would protect nothing.
pub fn try_lock(file: &File, path: &Path, sharing: Sharing) -> io::Result<bool> {
    let mut waited = Duration::ZERO;
    loop {
        let locked = match sharing {
            Sharing::Alone => file.try_lock(),
            Sharing::Shared => file.try_lock_shared(),
        };
        match locked {
            Ok(()) => return Ok(leads_to(path, file)),
            Err(TryLockError::Error(e)) => return Err(e),
            Err(TryLockError::WouldBlock) if waited >= PATIENCE => return Ok(false),
            Err(TryLockError::WouldBlock) => thread::sleep(PAUSE),
        }
        waited += PAUSE;
    }
}

pub fn leads_to(path: &Path, file: &File) -> bool {
    let same = |a: Metadata, b: Metadata| a.dev() == b.dev() && a.ino() == b.ino();
    file.metadata().and_then(|open| Ok(same(open, fs::metadata(path)?))).unwrap_or(false)
}

/// A lock file, for a folder or for a file that is replaced by renames. Its last holder removes it when dropped.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    file: File,
}

impl Lock {
    /// Locks a file for writing; the file need not exist. `field` names the file in an error.
    pub fn of_file(path: &Path, field: &str) -> Result<Self> {
        // If the path is a link, the lock file is beside the link's target.
        let file = followed(path).and_then(|path| path.canonicalize().or(Ok(path)));
        let file = file.map_err(|e| Error::system("locking", path, e))?;
        let name = digest::of_text(&file.file_name().unwrap_or_default().to_string_lossy());
        Self::new(&folder_of(&file).join(format!(".pathmark-{name}.lock")), field, path, Sharing::Alone)
    }

    pub fn of_folder(folder: &Path, field: &str, sharing: Sharing) -> Result<Self> {
        Self::new(&folder.join(".pathmark.lock"), field, folder, sharing)
    }

    /// Locks the file `path`, which is created if necessary. In an error, `field` and `of` name the file or folder that
    /// another process is writing.
    fn new(path: &Path, field: &str, of: &Path, sharing: Sharing) -> Result<Self> {
        let system = |e| Error::system("locking", path, e);
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false).custom_flags(libc::O_NOFOLLOW);
        // The previous holder may have removed the file while we waited: try once more, with a new file.
        for _ in 0..2 {
            let file = options.open(path).map_err(system)?;
            if file.metadata().map_err(system)?.len() > 0 {
                let problem = format!("cannot be locked: {} is not a lock file", path.display());
                return Err(InputError::new(field, of.display().to_string(), problem).allowed("another name").into());
            }
            if try_lock(&file, path, sharing).map_err(system)? {
                return Ok(Self { path: path.to_path_buf(), file });
            }
        }
        let problem = "is being written by another process";
        Err(InputError::new(field, of.display().to_string(), problem)
            .allowed("another name, or this one when that process has ended")
            .into())
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Removed only under an exclusive lock, so that no other process can have locked it meanwhile. A file that
        // stays locks nothing.
        if self.file.try_lock().is_ok() && leads_to(&self.path, &self.file) {
            fs::remove_file(&self.path).ok();
        }
    }
}
