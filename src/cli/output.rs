//! Where results go: a folder, or standard output, which a user may close at any time: `pathmark list | head -1` is no failure.

use crate::error::{Error, Result};
use crate::lock::{Lock, Sharing};
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Makes a folder of results if need be, and keeps others from it as long as the lock is held.
pub(super) fn lock_folder(out: &Path, sharing: Sharing) -> Result<Lock> {
    std::fs::create_dir_all(out).map_err(|e| Error::system("creating", out, e))?;
    Lock::of_folder(out, "out", sharing)
}

/// Prints a text and a line end.
pub(super) fn print(text: &str) -> Result<()> {
    match writeln!(std::io::stdout().lock(), "{text}") {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::system("writing", "standard output", e)),
        _ => Ok(()),
    }
}

/// Prints a value as one line of JSON.
pub(super) fn print_json(value: &impl serde::Serialize) -> Result<()> {
    let text = serde_json::to_string(value).map_err(|e| Error::system("writing", "standard output", e.into()))?;
    print(&text)
}
