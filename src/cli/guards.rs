//! Measuring the price list of the guards, for `check` and `reproduce`.

use crate::check::guards::{FILE, FOLDER, GUARDS, PriceRow, write_prices};
use crate::error::{Error, Result};
use crate::experiment::{Progress, RunFile};
use std::path::Path;

/// Whether a folder of results has the list already.
pub(super) fn are_in(out: &Path) -> bool {
    out.join(FOLDER).join(FILE).is_file()
}

/// Measures all guards, one after the other.
pub(super) fn measure(progress: &dyn Progress) -> Vec<PriceRow> {
    progress.begin("guards", GUARDS.len() as u64);
    let mut rows = Vec::new();
    for guard in GUARDS {
        rows.push(guard.price());
        progress.advance(rows.len() as u64);
    }
    progress.end();
    rows
}

/// Writes the list into a folder of results, with the command and the machine.
pub(super) fn write(out: &Path, rows: &[PriceRow]) -> Result<()> {
    let folder = out.join(FOLDER);
    std::fs::create_dir_all(&folder).map_err(|e| Error::system("creating", &folder, e))?;
    RunFile::of_now(super::command_line()).write(&folder.join("machine.toml"))?;
    write_prices(&folder.join(FILE), rows)
}
