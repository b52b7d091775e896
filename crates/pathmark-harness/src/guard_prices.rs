//! `guards.csv`: the measured price list of the guards that keep hard inputs correct.

use crate::csv_file;
use crate::error::Result;
use serde::{Deserialize, Serialize};
use std::path::Path;

pub const LEVEL: f64 = 0.95;

pub const FOLDER: &str = "guards";
pub const FILE: &str = "guards.csv";

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PriceRow {
    pub guard: String,
    /// Definition of the errors, with their unit.
    pub error: String,
    /// The program's method.
    pub with: String,
    /// The simpler alternative.
    pub without: String,
    /// Error of the program's method, with its 95 % interval.
    pub error_with: f64,
    pub error_with_low: f64,
    pub error_with_high: f64,
    pub error_without: f64,
    pub error_without_low: f64,
    pub error_without_high: f64,
    pub operation: String,
    /// Median nanoseconds per operation of the program's method; empty if it could not be timed.
    pub ns_with: Option<f64>,
    pub ns_without: Option<f64>,
    /// Time with the guard divided by time without, in adjacent rounds, with its 95 % interval over processes.
    pub time_ratio: Option<f64>,
    pub time_ratio_low: Option<f64>,
    pub time_ratio_high: Option<f64>,
    /// A scene whose render contains the operation; empty in files of older versions.
    #[serde(default)]
    pub scene: String,
    /// How often, in words.
    #[serde(default)]
    pub often: String,
    /// Operations of a sample.
    #[serde(default)]
    pub operations: Option<f64>,
    /// Nanoseconds of a sample of that render, on one thread with the scalar kernel.
    #[serde(default)]
    pub render_ns: Option<f64>,
    /// The share of the render's time that the guard costs, with its 95 % interval over processes; negative if it saves time.
    #[serde(default)]
    pub share: Option<f64>,
    #[serde(default)]
    pub share_low: Option<f64>,
    #[serde(default)]
    pub share_high: Option<f64>,
    #[serde(default)]
    pub processes: Option<usize>,
}

pub fn write_prices(path: &Path, rows: &[PriceRow]) -> Result<()> {
    csv_file::write(path, rows)
}

pub fn read_prices(path: &Path) -> Result<Vec<PriceRow>> {
    csv_file::read(path)
}
