//! `calibration.csv`: the costs of handing out empty jobs on the machine of a sweep.

use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::lab::Lab;
use crate::measure::{CalibrationRow, calibrate};
use std::path::Path;

/// Times all strategies of the table and writes the file.
pub(super) fn write_calibration(lab: &Lab, path: &Path) -> Result<()> {
    let strategies: Vec<String> = lab.strategies().iter().map(|entry| entry.name.to_string()).collect();
    let system = |e: std::io::Error| Error::system("writing", path, e);
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in calibrate(lab, &strategies)? {
        writer.serialize(row).map_err(|e| system(e.into()))?;
    }
    let bytes = writer.into_inner().map_err(|e| system(e.into_error()))?;
    atomic_file::write(path, |file| file.write_all(&bytes))
}

/// Reads the file.
pub fn read_calibration(path: &Path) -> Result<Vec<CalibrationRow>> {
    let mut reader = csv::Reader::from_path(path).map_err(|e| Error::system("reading", path, e.into()))?;
    let row = |(index, row): (usize, csv::Result<CalibrationRow>)| {
        row.map_err(|e| {
            let error = InputError::new("row", "", format!("cannot be read: {e}"));
            error.in_file(path.display().to_string(), Some((index + 2, 1))).into()
        })
    };
    reader.deserialize().enumerate().map(row).collect()
}
