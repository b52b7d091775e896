//! `guards.csv`: the price list as it was measured.

use super::{Guard, Measured};
use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::measure::InTurns;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The folder of results that has the list.
pub const FOLDER: &str = "guards";
/// The list's file in it.
pub const FILE: &str = "guards.csv";

/// What one guard costs and saves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PriceRow {
    /// What is guarded.
    pub guard: String,
    /// What the errors are, with their unit.
    pub error: String,
    /// The program's way.
    pub with: String,
    /// The other.
    pub without: String,
    /// Error of the program's way, and its interval of 95 %.
    pub error_with: f64,
    /// Lower end.
    pub error_with_low: f64,
    /// Upper end.
    pub error_with_high: f64,
    /// Error of the other.
    pub error_without: f64,
    /// Lower end.
    pub error_without_low: f64,
    /// Upper end.
    pub error_without_high: f64,
    /// What is timed.
    pub operation: String,
    /// Median nanoseconds of one, the program's way; empty if it could not be timed.
    pub ns_with: Option<f64>,
    /// The other way.
    pub ns_without: Option<f64>,
    /// Time with the guard over time without: median over paired rounds, and its interval of 95 %.
    pub time_ratio: Option<f64>,
    /// Lower end.
    pub time_ratio_low: Option<f64>,
    /// Upper end.
    pub time_ratio_high: Option<f64>,
}

impl PriceRow {
    pub(super) fn new(guard: &Guard, with: Measured, without: Measured, times: Option<InTurns>) -> Self {
        Self {
            guard: guard.name.to_string(),
            error: guard.error.to_string(),
            with: guard.with.name.to_string(),
            without: guard.without.name.to_string(),
            error_with: with.value,
            error_with_low: with.low,
            error_with_high: with.high,
            error_without: without.value,
            error_without_low: without.low,
            error_without_high: without.high,
            operation: guard.operation.to_string(),
            ns_with: times.map(|times| times.first_ns),
            ns_without: times.map(|times| times.second_ns),
            time_ratio: times.map(|times| times.ratio.value),
            time_ratio_low: times.map(|times| times.ratio.interval.low),
            time_ratio_high: times.map(|times| times.ratio.interval.high),
        }
    }
}

/// Writes the list.
pub fn write_prices(path: &Path, rows: &[PriceRow]) -> Result<()> {
    atomic_file::write(path, |file| {
        let mut writer = csv::Writer::from_writer(file);
        for row in rows {
            writer.serialize(row)?;
        }
        writer.flush()
    })
}

/// Reads a list.
pub fn read_prices(path: &Path) -> Result<Vec<PriceRow>> {
    let file = std::fs::File::open(path).map_err(|e| Error::system("reading", path, e))?;
    let rows: std::result::Result<_, csv::Error> = csv::Reader::from_reader(file).deserialize().collect();
    rows.map_err(|error| {
        let line = error.position().map(|position| (position.line() as usize, 1));
        InputError::new("row", "", error.to_string()).in_file(path.display().to_string(), line).into()
    })
}
