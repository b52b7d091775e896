//! The price list of the guards: measures, reads and writes it for `selftest` and `reproduce`.

use crate::check::guards::GUARDS;
use crate::error::{Error, Result};
use crate::experiment::{MACHINE, Progress, RunFile, read_run_file};
use crate::files::Files;
use crate::guard_prices::{FILE, FOLDER, PriceRow, read_prices, write_prices};
use crate::lab::Lab;
use std::path::Path;

/// Whether a folder of results has the list already.
pub(super) fn are_in(out: &Path) -> bool {
    out.join(FOLDER).join(FILE).is_file()
}

/// Reads the list in a folder of results.
pub(super) fn read(out: &Path) -> Result<Vec<PriceRow>> {
    read_prices(&out.join(FOLDER).join(FILE))
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

/// Adds the list to the files that a command will write. Refuses a folder that has one: measurements are never
/// overwritten.
pub(super) fn claim(out: &Path, files: &mut Files) -> Result<()> {
    let folder = out.join(FOLDER);
    files.renews("out", &folder.join(FILE), |_| false)?;
    files.renews("out", &folder.join(MACHINE), |path| read_run_file(path).is_ok())
}

/// Writes the list into a folder of results, with the command and the machine.
pub(super) fn write(out: &Path, lab: &Lab, rows: &[PriceRow]) -> Result<()> {
    let folder = out.join(FOLDER);
    std::fs::create_dir_all(&folder).map_err(|e| Error::system("creating", &folder, e))?;
    let program = lab.program().join(" ");
    RunFile { program, ..RunFile::of_now(crate::command_line()) }.write(&folder.join(MACHINE))?;
    write_prices(&folder.join(FILE), rows)
}
