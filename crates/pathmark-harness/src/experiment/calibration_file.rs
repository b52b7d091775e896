//! `calibration.csv`: the costs of handing out empty jobs on the machine of a sweep.

use crate::csv_file;
use crate::error::Result;
use crate::lab::Lab;
use crate::measure::{CalibrationRow, calibrate};
use std::path::Path;

/// Times all strategies of the table and writes the file.
pub(super) fn write_calibration(lab: &Lab, path: &Path) -> Result<()> {
    let strategies: Vec<String> = lab.strategies().iter().map(|entry| entry.name.to_string()).collect();
    csv_file::write(path, calibrate(lab, &strategies)?)
}

/// Reads the file.
pub fn read_calibration(path: &Path) -> Result<Vec<CalibrationRow>> {
    csv_file::read(path)
}
