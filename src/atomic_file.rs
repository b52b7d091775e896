//! Output files that appear whole or not at all.
//!
//! The bytes go to a temporary file in the destination's own directory, are synced, and take the destination's name in one
//! rename. A reader, or a run that is resumed after a crash, sees the old file or the new one and nothing between; a failure
//! leaves the old file as it was and no temporary file behind.
//!
//! A destination that cannot be a file at all (a directory, a device, a name that is too long, a directory that is not there)
//! is the user's to mend: [`InputError`] on the field `output`. A refusal of the system (permission, space, a read-only file
//! system) is [`Error::System`].

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::disk::{OnDisk, Step, step};
use crate::error::{Error, InputError, Result};

/// Writes what `body` writes to the file `path`, or leaves `path` as it was. A symbolic link is followed, not replaced.
pub fn write(path: &Path, body: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    let target = Target::of(path)?;
    target.replace(body).map_err(|e| Error::system("writing", path, e))
}

/// Asks whether [`write()`] to `path` could succeed, and leaves nothing behind; to be asked before hours of work depend on it.
pub fn check_writable(path: &Path) -> Result<()> {
    let target = Target::of(path)?;
    let try_it = || {
        if target.exists {
            // The rename would replace a write-protected file as well, but its owner meant it to stay.
            OpenOptions::new().write(true).open(&target.file)?;
        }
        target.temporary().and_then(NamedTempFile::close)
    };
    try_it().map_err(|e| Error::system("writing", path, e))
}

/// A destination that may be a regular file.
struct Target {
    file: PathBuf,
    directory: PathBuf,
    exists: bool,
}

impl Target {
    /// Follows links, and refuses what no permission and no free space could make a file.
    fn of(path: &Path) -> Result<Self> {
        let refuse = |problem: &str| InputError::new("output", path.display().to_string(), problem);
        let text = path.as_os_str().as_encoded_bytes();
        if text.is_empty() || path.file_name().is_none() || text.ends_with(b"/") {
            return Err(refuse("is not the name of a file").into());
        }
        let (file, exists) = match fs::metadata(path) {
            Ok(found) if found.is_dir() => return Err(refuse("is a directory").into()),
            // Renaming onto a device would put a plain file in the place of, say, /dev/null.
            Ok(found) if !found.is_file() => return Err(refuse("is not a regular file").into()),
            Ok(_) => (fs::canonicalize(path).map_err(|e| Error::system("writing", path, e))?, true),
            Err(e) => match e.kind() {
                ErrorKind::NotFound => (path.to_path_buf(), false),
                ErrorKind::NotADirectory => return Err(refuse("a part of the path is not a directory").into()),
                ErrorKind::InvalidFilename => return Err(refuse("the name is too long").into()),
                ErrorKind::InvalidInput => return Err(refuse("the name holds a zero byte").into()),
                _ => return Err(Error::system("writing", path, e)),
            },
        };
        let directory = match file.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
            _ => PathBuf::from("."),
        };
        if !exists && !directory.is_dir() {
            return Err(refuse("its directory does not exist").into());
        }
        Ok(Self { file, directory, exists })
    }

    /// A new file beside the destination; it deletes itself unless it is renamed.
    fn temporary(&self) -> io::Result<NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".pathmark-").suffix(".tmp");
        // An output is as public as any file the user makes: the umask decides, not tempfile's 0600.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        step(Step::Create)?;
        builder.tempfile_in(&self.directory)
    }

    fn replace(&self, body: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        let mut out = BufWriter::new(OnDisk(self.temporary()?));
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
