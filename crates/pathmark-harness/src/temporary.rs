//! Temporary files beside their destinations, and the removal of those whose writer was killed.
//!
//! A writer locks its temporary file until the file has its final name. The system releases the lock when the writer
//! ends in any way, so a file that another process can lock is abandoned. Process numbers are not used: they are
//! assigned again, and mean nothing on another host.
//!
//! On some shared folders, locks hold only within one host. The name of a file therefore contains the boot of the
//! system that wrote it. A file of another boot counts as abandoned only if it has also not been written to for a day.

use crate::disk::{Step, step};
use crate::lock::leads_to;
use std::fs::{self, DirEntry, File, OpenOptions, TryLockError};
use std::io;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::sync::LazyLock;
use std::time::Duration;
use tempfile::NamedTempFile;

const PREFIX: &str = ".pathmark-";
const SUFFIX: &str = ".tmp";
/// No writer pauses as long as this between two writes.
const ABANDONED_AFTER: Duration = Duration::from_hours(24);
/// Attempts to create a file. Another process that cleans up may take a new file for abandoned before it is locked, but
/// rarely several times in a row.
const ATTEMPTS: usize = 16;

/// The prefix of this system's file names, the same for all of its processes until the next boot.
static OWN_PREFIX: LazyLock<String> = LazyLock::new(|| {
    let boot = fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default();
    let word: String = boot.chars().filter(char::is_ascii_hexdigit).take(16).collect();
    format!("{PREFIX}{word}-")
});

/// Creates a locked file in the folder, which deletes itself unless it is renamed. Removes the folder's abandoned files
/// first.
pub(crate) fn new_in(folder: &Path) -> io::Result<NamedTempFile> {
    remove_abandoned(folder);
    step(Step::Create)?;
    let mut builder = tempfile::Builder::new();
    // The umask decides about the permissions of an output, as for any file of the user, and not tempfile's 0600.
    builder.prefix(&*OWN_PREFIX).suffix(SUFFIX).permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    for _ in 0..ATTEMPTS {
        let file = builder.tempfile_in(folder)?;
        match file.as_file().try_lock() {
            Ok(()) if !leads_to(file.path(), file.as_file()) => {}
            Err(TryLockError::WouldBlock) => {}
            // On a file system without locks, no process can lock the file, so none removes it either.
            Ok(()) | Err(TryLockError::Error(_)) => return Ok(file),
        }
    }
    Err(io::Error::other("another process removes each temporary file"))
}

/// Removes the temporary files in a folder whose writers have ended. A file that cannot be removed stays and does no
/// harm.
pub(crate) fn remove_abandoned(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        // The lock is held until the file is gone.
        if let Some(_locked) = abandoned(&entry) {
            fs::remove_file(entry.path()).ok();
        }
    }
}

/// Returns the file, locked, if it is a temporary file without a writer.
fn abandoned(entry: &DirEntry) -> Option<File> {
    let name =
        entry.file_name().into_string().ok().filter(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX))?;
    let flags = libc::O_NOFOLLOW | libc::O_NONBLOCK;
    let file = OpenOptions::new().read(true).write(true).custom_flags(flags).open(entry.path()).ok()?;
    let data = file.metadata().ok().filter(fs::Metadata::is_file)?;
    let is_old = || data.modified().ok().and_then(|time| time.elapsed().ok()).is_some_and(|age| age > ABANDONED_AFTER);
    let may_be_dead = name.starts_with(&*OWN_PREFIX) || is_old();
    (may_be_dead && file.try_lock().is_ok() && leads_to(&entry.path(), &file)).then_some(file)
}
