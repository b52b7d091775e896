//! Output files that appear whole or not at all.
//!
//! The bytes are written to a temporary file in the destination's own directory and synced; one rename then gives the
//! file the destination's name. A reader, or a run that is resumed after a crash, sees either the old file or the new
//! one. A failure leaves the old file unchanged and no temporary file behind.
//!
//! A destination that cannot be a file (a directory, a device, a name that is too long, a directory that does not
//! exist) is an [`InputError`], for the user to correct. A refusal of the system (permission, space, a read-only file
//! system) is [`Error::System`].

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::disk::{OnDisk, Step, step};
use crate::error::{Error, InputError, Result};
use crate::file_id::{folder_of, followed};
use crate::temporary;

/// Writes the output of `body` to the file `path`, or leaves `path` unchanged. A symbolic link is followed, not
/// replaced, even if its target does not exist yet.
pub fn write(path: &Path, body: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    let target = Target::of("file", path)?;
    target.replace(body).map_err(|e| Error::system("writing", path, e))
}

/// Checks that [`write()`] to `path` could succeed, and leaves no file behind. Call it before hours of work depend on
/// it. An error names `option`, with which the user gave the path.
pub fn check_writable(option: &str, path: &Path) -> Result<()> {
    let target = Target::of(option, path)?;
    let try_it = || {
        if target.exists {
            // The rename would even replace a write-protected file, but its owner intended it to stay.
            OpenOptions::new().write(true).open(&target.file)?;
        }
        temporary::new_in(&target.directory).and_then(NamedTempFile::close)
    };
    try_it().map_err(|e| Error::system("writing", path, e))
}

/// Returns the reason why `found` cannot be replaced by a regular file; `None` if it can.
pub(crate) fn obstacle(found: &fs::Metadata) -> Option<&'static str> {
    match found {
        found if found.is_dir() => Some("is a directory"),
        // A rename onto a device would replace, for example, /dev/null by a plain file.
        found if !found.is_file() => Some("is not a regular file"),
        _ => None,
    }
}

/// The longest file name that all common file systems accept, in bytes.
const LONGEST_NAME: usize = 255;

/// Refuses a path whose file name is too long for any file; used for a file whose folder is created later.
pub fn check_name(path: &Path) -> Result<()> {
    let name = path.file_name().unwrap_or_default();
    if name.len() <= LONGEST_NAME {
        return Ok(());
    }
    let problem = format!("the file name would have {} bytes", name.len());
    let error = InputError::new("output", name.to_string_lossy(), problem);
    Err(error.allowed(format!("up to {LONGEST_NAME} bytes")).into())
}

struct Target {
    file: PathBuf,
    directory: PathBuf,
    exists: bool,
}

impl Target {
    /// Follows links, and refuses a destination that cannot be a file even with every permission and enough space.
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
                ErrorKind::InvalidInput => return Err(refuse("the name contains a zero byte").into()),
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
        // The rename is already visible. If a directory cannot be synced (some network file systems), a power cut can
        // still restore the old file, whole; this is not reported as a failure.
        File::open(&self.directory).and_then(|directory| directory.sync_all()).ok();
        Ok(())
    }
}
