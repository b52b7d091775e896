//! Rows in CSV files.

use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;

/// Writes rows with the names of their columns above them.
pub fn write<R: Serialize>(path: &Path, rows: impl IntoIterator<Item = R>) -> Result<()> {
    atomic_file::write(path, |file| {
        let mut writer = csv::Writer::from_writer(file);
        rows.into_iter().try_for_each(|row| writer.serialize(row))?;
        writer.flush()
    })
}

/// Reads all rows.
pub fn read<R: DeserializeOwned>(path: &Path) -> Result<Vec<R>> {
    let file = std::fs::File::open(path).map_err(|e| Error::system("reading", path, e))?;
    let rows: csv::Result<Vec<R>> = csv::Reader::from_reader(file).into_deserialize().collect();
    rows.map_err(|error| {
        let at = error.position().map(|position| (position.line() as usize, 1));
        let problem = format!("cannot be read: {error}");
        InputError::new("row", "", problem).in_file(path.display().to_string(), at).into()
    })
}
