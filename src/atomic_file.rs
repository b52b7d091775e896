//! Output files that appear whole or not at all.
//!
//! The bytes go to a temporary file in the destination's own directory, are synced, and take the destination's name in one
//! rename. A reader, or a run that is resumed after a crash, sees the old file or the new one and nothing between; a failure
//! leaves the old file as it was and no temporary file behind.
//!
//! A destination that cannot be a file at all (a directory, a device, a name that is too long, a directory that is not there)
//! is the user's to mend: [`InputError`]. A refusal of the system (permission, space, a read-only file system) is [`Error::System`].

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::disk::{OnDisk, Step, step};
use crate::error::{Error, InputError, Result};
use crate::file_id::{folder_of, followed};
use crate::temporary;

/// Writes what `body` writes to the file `path`, or leaves `path` as it was. A symbolic link is followed, not replaced, also where it
/// leads to nothing yet.
pub fn write(path: &Path, body: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    let target = Target::of("file", path)?;
    target.replace(body).map_err(|e| Error::system("writing", path, e))
}

/// Asks whether [`write()`] to `path` could succeed, and leaves nothing behind; to be asked before hours of work depend on it. `option` is
/// what the user gave the path for, and named in an error.
pub fn check_writable(option: &str, path: &Path) -> Result<()> {
    let target = Target::of(option, path)?;
    let try_it = || {
        if target.exists {
            // The rename would replace a write-protected file as well, but its owner meant it to stay.
            OpenOptions::new().write(true).open(&target.file)?;
        }
        temporary::new_in(&target.directory).and_then(NamedTempFile::close)
    };
    try_it().map_err(|e| Error::system("writing", path, e))
}

/// What keeps `found` from being replaced by a regular file.
pub(crate) fn obstacle(found: &fs::Metadata) -> Option<&'static str> {
    match found {
        found if found.is_dir() => Some("is a directory"),
        // Renaming onto a device would put a plain file in the place of, say, /dev/null.
        found if !found.is_file() => Some("is not a regular file"),
        _ => None,
    }
}

/// The longest name of a file that all the usual file systems take, in bytes.
const LONGEST_NAME: usize = 255;

/// Refuses a path that ends in a name which no file can have: for a file whose folder is made later.
pub fn check_name(path: &Path) -> Result<()> {
    let name = path.file_name().unwrap_or_default();
    if name.len() <= LONGEST_NAME {
        return Ok(());
    }
    let problem = format!("would need a file with a name of {} bytes", name.len());
    let error = InputError::new("output", name.to_string_lossy(), problem);
    Err(error.allowed(format!("up to {LONGEST_NAME} bytes")).into())
}

/// A destination that may be a regular file.
struct Target {
    file: PathBuf,
    directory: PathBuf,
    exists: bool,
}

impl Target {
    /// Follows links, and refuses what no permission and no free space could make a file.
    fn of(option: &str, path: &Path) -> Result<Self> {
        let refuse = |problem: &str| InputError::new(option, path.display().to_string(), problem);
        let text = path.as_os_str().as_encoded_bytes();
        if text.is_empty() || path.file_name().is_none() || text.ends_with(b"/") {
            return Err(refuse("is not the name of a file").into());
        }
        let file = followed(path).map_err(|e| Error::system("writing", path, e))?;
        let exists = match fs::metadata(&file) {
            Ok(found) => match obstacle(&found) {
                None => true,
                Some(problem) => return Err(refuse(problem).into()),
            },
            Err(e) => match e.kind() {
                ErrorKind::NotFound => false,
                ErrorKind::NotADirectory => return Err(refuse("a part of the path is not a directory").into()),
                ErrorKind::InvalidFilename => return Err(refuse("the name is too long").into()),
                ErrorKind::InvalidInput => return Err(refuse("the name holds a zero byte").into()),
                _ => return Err(Error::system("writing", path, e)),
            },
        };
        let directory = folder_of(&file).to_path_buf();
        if !exists && !directory.is_dir() {
            return Err(refuse("its directory does not exist").into());
        }
        Ok(Self { file, directory, exists })
    }

    fn replace(&self, body: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        let mut out = BufWriter::new(OnDisk(temporary::new_in(&self.directory)?));
        body(&mut out)?;
        let OnDisk(file) = out.into_inner().map_err(io::IntoInnerError::into_error)?;
        step(Step::Sync)?;
        file.as_file().sync_all()?;
        step(Step::Rename)?;
        file.persist(&self.file).map_err(|refusal| refusal.error)?;
        // The rename has happened and is visible. Where a directory cannot be synced (some network file systems), a power cut
        // may still bring the old file back, whole; that is no reason to report a failure.
        File::open(&self.directory).and_then(|directory| directory.sync_all()).ok();
        Ok(())
    }
}
