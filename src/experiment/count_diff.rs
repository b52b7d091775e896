//! Two measurements of the same cells by what was counted: work that the program does, whatever the machine is busy with.

use super::diff::{Side, sides};
use crate::error::Result;
use crate::measure::Record;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// A number of a row, if it was counted.
type Count = fn(&Record) -> Option<u64>;

/// What is counted, as the columns are called. None of it depends on who renders when.
const COUNTS: [(&str, Count); 5] = [
    ("jobs", |row| Some(row.jobs as u64)),
    ("paths", |row| row.paths),
    ("rays", |row| row.rays),
    ("box_tests", |row| row.box_tests),
    ("primitive_tests", |row| row.primitive_tests),
];

/// Instructions are counted beside the rows. They repeat to within this share: where memory lies differs from run to run.
const INSTRUCTIONS: &str = "instructions";
const REPEATS: f64 = 1e-3;

/// A number of a cell in both measurements.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CountDiff {
    /// The cell.
    pub cell: String,
    /// The column.
    pub column: &'static str,
    /// The largest number of its repetitions before.
    pub old: u64,
    /// And after.
    pub new: u64,
}

impl CountDiff {
    /// New over old; infinite if there was none.
    pub fn ratio(&self) -> f64 {
        if self.old == self.new { 1.0 } else { self.new as f64 / self.old as f64 }
    }
}

/// What changed among the counts of the cells that both have, and how many numbers were compared.
pub fn count_diff(old: &Path, new: &Path) -> Result<(Vec<CountDiff>, usize)> {
    // What is counted is the same on every machine.
    let [old, new] = sides(old, new, true)?;
    let (old, new) = (counts(&old), counts(&new));
    let both = || old.iter().filter_map(|(key, old)| Some((key, *old, *new.get(key)?)));
    let differs = |column: &str, old: u64, new: u64| {
        let slack = if column == INSTRUCTIONS { REPEATS * old as f64 } else { 0.0 };
        old.abs_diff(new) as f64 > slack
    };
    let changed = both().filter(|((_, column), old, new)| differs(column, *old, *new));
    let found = changed.map(|((cell, column), old, new)| CountDiff { cell: cell.clone(), column, old, new });
    Ok((found.collect(), both().count()))
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
