//! Comparison of two measurements of the same cells: which cells got slower, and which are lost?
//!
//! All intervals of a comparison, over all of its experiments, hold together with 95 % confidence (Bonferroni).

use super::cell_diff::{CellDiff, Judge, Pairing, Times, turn};
use super::run_file::RunFile;
use super::sides::{Compared, Lost, Side, check_images, sides};
use crate::error::{InputError, Result};
use crate::measure::{Record, TimingConcerns};
use std::collections::BTreeMap;
use std::path::Path;

/// Two measurements of an experiment, cell by cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Diff {
    /// The cells that both have.
    pub cells: Vec<CellDiff>,
    /// The cells that only the old one has.
    pub lost: Lost,
    /// Numbers of cells with times that have none in the other measurement: of the old and of the new one.
    pub unmatched: [usize; 2],
    /// Whether rows were compared in pairs.
    pub paired: bool,
    /// Whether repetitions had a goal, and the intervals allow for that.
    pub sequential: bool,
    /// Whether repetitions had a goal, and the intervals do not allow for that.
    pub stopped_by_times: bool,
    /// Doubts about all times.
    pub doubts: TimingConcerns,
}

/// Parses a share by which a cell may get slower, such as `0.03` or `3%`.
pub fn parse_share(field: &str, text: &str) -> Result<f64> {
    let parsed = match text.strip_suffix('%') {
        Some(percent) => percent.trim().parse::<f64>().map(|percent| percent / 100.0),
        None => text.parse(),
    };
    parsed.ok().filter(|share| share.is_finite() && *share >= 0.0).ok_or_else(|| {
        let error = InputError::new(field, text, "is not a valid share");
        error.allowed("numbers from 0, such as 0.03 or 3%").into()
    })
}

/// Differences with which measurements may still be compared.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Across {
    /// Whether the machines may differ.
    pub machines: bool,
    /// Whether the builds may render other bits, so that their work is not known to be equal.
    pub revisions: bool,
}

/// Compares two measurements: two experiments, or the experiments of equal name in two folders. `limit` is the share by
/// which a cell may get slower, such as 0.03. Refuses measurements that differ in more than `across` allows.
pub fn diff(old: &Path, new: &Path, limit: f64, across: Across) -> Result<Compared<Diff>> {
    if !(limit.is_finite() && limit >= 0.0) {
        let error = InputError::new("fail-above", limit.to_string(), "is not a valid share");
        return Err(error.allowed("numbers from 0, such as 0.03 or 3%").into());
    }
    let compared = sides(old, new, across.machines)?.map(|(name, sides)| {
        if !across.revisions {
            check_images(&sides)?;
        }
        let times = sides.each_ref().map(|side| times(&side.rows));
        Ok((name, (sides, times)))
    })?;
    let in_common = |[before, after]: &[Cells; 2]| before.keys().filter(|cell| after.contains_key(*cell)).count();
    let judge = Judge::new(compared.experiments.iter().map(|(_, (_, times))| in_common(times)).sum(), limit);
    let diffs =
        compared.experiments.iter().map(|(name, (sides, times))| (name.clone(), of_experiment(sides, times, &judge)));
    Ok(Compared { experiments: diffs.collect(), alone: compared.alone })
}

/// The seconds of each cell, by repetition.
type Cells = BTreeMap<String, Times>;

/// Rows that failed have no time.
fn times(rows: &[Record]) -> Cells {
    let mut times = Cells::new();
    for row in rows.iter().filter(|row| row.error.is_empty()) {
        if let Some(seconds) = row.makespan_s {
            times.entry(row.cell.clone()).or_default().insert(turn(row), seconds);
        }
    }
    times
}

fn of_experiment(sides: &[Side; 2], [before, after]: &[Cells; 2], judge: &Judge) -> Diff {
    let has_goal = |side: &Side| side.run.as_ref().is_some_and(|run: &RunFile| run.until.is_some());
    let pairing = match sides {
        [old, new] if !old.is_in_turns_with(new) => Pairing::None,
        [old, new] if has_goal(old) || has_goal(new) => Pairing::Sequential,
        _ => Pairing::Paired,
    };
    let both = before.iter().filter_map(|(cell, old)| Some((cell, old, after.get(cell)?)));
    let cells: Vec<CellDiff> = both.filter_map(|(cell, old, new)| judge.compare(cell, pairing, old, new)).collect();
    let warnings = sides.iter().flat_map(|side| &side.rows).map(|row| row.warnings.as_str());
    Diff {
        lost: Lost::of(sides, |row| row.makespan_s.is_some()),
        unmatched: [before.len() - cells.len(), after.len() - cells.len()],
        cells,
        paired: pairing != Pairing::None,
        sequential: pairing == Pairing::Sequential,
        stopped_by_times: pairing == Pairing::None && sides.iter().any(has_goal),
        doubts: TimingConcerns::of(warnings),
    }
}
