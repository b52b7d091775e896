//! Standard output, which a user may close at any time: `pathmark list | head -1` is no failure.

use crate::error::{Error, Result};
use std::io::{ErrorKind, Write};

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
