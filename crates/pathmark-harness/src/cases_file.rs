//! `check/cases.csv`: the outcome of each hard case, as evidence for claims.

use crate::csv_file;
use crate::error::{Error, Result};
use crate::files::Files;
use serde::{Deserialize, Serialize};
use std::path::Path;

pub const FOLDER: &str = "check";
pub const FILE: &str = "cases.csv";

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseRow {
    pub id: String,
    pub tries: String,
    pub pass: bool,
    pub trials: usize,
    pub failed: usize,
    /// Variant of the trial that is shown: the first that failed, or else the last.
    pub variant: String,
    pub expected: String,
    pub found: String,
    /// Why the case, or a part of it, was skipped.
    pub skipped: String,
}

pub fn is_in(out: &Path) -> bool {
    out.join(FOLDER).join(FILE).is_file()
}

/// Enters the list into the files that a command will write. Refuses a folder that has one: results are never
/// overwritten.
pub fn claim(out: &Path, files: &mut Files) -> Result<()> {
    files.renews("out", &out.join(FOLDER).join(FILE), |_| false)
}

pub fn write(out: &Path, rows: &[CaseRow]) -> Result<()> {
    let folder = out.join(FOLDER);
    std::fs::create_dir_all(&folder).map_err(|e| Error::system("creating", &folder, e))?;
    csv_file::write(&folder.join(FILE), rows)
}

/// The list in a folder of results; empty if there is none.
pub fn read(out: &Path) -> Result<Vec<CaseRow>> {
    let path = out.join(FOLDER).join(FILE);
    if path.is_file() { csv_file::read(&path) } else { Ok(Vec::new()) }
}
