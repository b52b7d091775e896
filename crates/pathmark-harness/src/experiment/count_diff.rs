//! Comparison of two measurements of the same cells by counts: the program's work, however busy the machine is.

use super::sides::{Compared, Lost, Side, sides};
use crate::error::Result;
use crate::measure::Record;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Reads a count of a row; `None` if it was not counted.
type Count = fn(&Record) -> Option<u64>;

/// The counts, by the names of their columns. None of them depends on the schedule.
const COUNTS: [(&str, Count); 5] = [
    ("jobs", |row| Some(row.jobs as u64)),
    ("samples", |row| row.samples),
    ("rays", |row| row.rays),
    ("box_tests", |row| row.box_tests),
    ("primitive_tests", |row| row.primitive_tests),
];

/// The column of instructions, which are counted beside the rows.
const INSTRUCTIONS: &str = "instructions";
/// Instruction counts repeat to within this share: memory addresses differ from run to run.
const REPEATS: f64 = 1e-3;

#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CountDiff {
    pub cell: String,
    pub column: &'static str,
    /// The largest count of its repetitions in the old measurement.
    pub old: u64,
    pub new: u64,
}

impl CountDiff {
    /// New over old; infinite if only the old count is 0.
    pub fn ratio(&self) -> f64 {
        if self.old == self.new { 1.0 } else { self.new as f64 / self.old as f64 }
    }
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CountDiffs {
    pub changed: Vec<CountDiff>,
    pub compared: usize,
    #[serde(flatten)]
    pub lost: Lost,
}

/// Compares the counts of two measurements: of two experiments, or of those of equal name in two folders.
pub fn count_diff(old: &Path, new: &Path) -> Result<Compared<CountDiffs>> {
    // Counts are the same on every machine.
    sides(old, new, true)?.map(|(name, sides)| Ok((name, of_experiment(&sides))))
}

fn of_experiment(sides: &[Side; 2]) -> CountDiffs {
    let [old, new] = sides.each_ref().map(counts);
    let both = || old.iter().filter_map(|(key, old)| Some((key, *old, *new.get(key)?)));
    let differs = |column: &str, old: u64, new: u64| {
        let slack = if column == INSTRUCTIONS { REPEATS * old as f64 } else { 0.0 };
        old.abs_diff(new) as f64 > slack
    };
    let changed = both().filter(|((_, column), old, new)| differs(column, *old, *new));
    let found = changed.map(|((cell, column), old, new)| CountDiff { cell: cell.clone(), column, old, new });
    CountDiffs { changed: found.collect(), compared: both().count(), lost: Lost::of(sides, |row| !row.is_left_out()) }
}

fn counts(side: &Side) -> BTreeMap<(String, &'static str), u64> {
    let told = side.instructions.iter().map(|(cell, count)| ((cell.clone(), INSTRUCTIONS), *count));
    let mut counts: BTreeMap<(String, &'static str), u64> = told.collect();
    for row in side.rows.iter().filter(|row| row.error.is_empty()) {
        for (column, value) in COUNTS.iter().filter_map(|(column, value)| Some((*column, value(row)?))) {
            let most = counts.entry((row.cell.clone(), column)).or_default();
            *most = value.max(*most);
        }
    }
    counts
}
