//! Comparison of two measurements of the same cells: which cells got slower?
//!
//! Rows that were measured in pairs (`run --against`) give a ratio for each repetition; other rows give the ratios of
//! all pairs of an old and a new time. All intervals of a comparison together hold with 95 % confidence (Bonferroni).
//! If repetitions in pairs had a goal (`run --until`), the intervals hold at every look.

use super::instructions;
use super::records_file::read_records;
use super::run_file::{MACHINE, RunFile, read_run_file};
use crate::analysis::confidence_sequence::median_sequence;
use crate::analysis::quantile::{median, median_interval};
use crate::analysis::rank_sum;
use crate::analysis::{Estimate, Interval};
use crate::error::{InputError, Result};
use crate::measure::{Doubts, Record};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// The probability that any interval of a comparison misses.
const MISS: f64 = 0.05;

/// The result of a comparison for a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Change {
    /// The whole interval is above the limit.
    Slower,
    /// The whole interval is below 1.
    Faster,
    /// The whole interval is within the limit of 1.
    Same,
    /// The interval is too wide, or there are too few repetitions for one.
    Undecided,
}

impl Change {
    /// The word in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slower => "slower",
            Self::Faster => "faster",
            Self::Same => "same",
            Self::Undecided => "undecided",
        }
    }
}

/// A cell in both measurements.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CellDiff {
    /// The cell.
    pub cell: String,
    /// Median seconds in the old measurement.
    pub old_s: f64,
    /// Median seconds in the new measurement.
    pub new_s: f64,
    /// Numbers of times that were compared, old and new.
    pub repetitions: [usize; 2],
    /// New over old.
    pub ratio: f64,
    /// The interval of the ratio.
    pub interval: Option<Interval>,
    /// The conclusion from the interval.
    pub change: Change,
}

/// Two measurements, cell by cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Diff {
    /// The cells that both have.
    pub cells: Vec<CellDiff>,
    /// Numbers of cells that only the old measurement has, and that only the new one has.
    pub unmatched: [usize; 2],
    /// Whether rows were compared in pairs.
    pub paired: bool,
    /// Whether repetitions had a goal, and the intervals allow for that.
    pub sequential: bool,
    /// Whether repetitions had a goal, and the intervals do not allow for that.
    pub stopped_by_times: bool,
    /// Doubts about all times.
    pub doubts: Doubts,
}

/// How times of a cell are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pairing {
    /// Each old time with each new one.
    None,
    /// Within a repetition.
    Paired,
    /// Within a repetition, with a look at the intervals after each repetition.
    Sequential,
}

/// The confidence of each interval in a comparison of `cells` cells.
pub(super) fn level_of(cells: usize) -> f64 {
    1.0 - MISS / cells as f64
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

/// The rows of a measurement, and their origin.
pub(super) struct Side {
    run: Option<RunFile>,
    pub(super) rows: Vec<Record>,
    /// The instructions of cells, if they were counted.
    pub(super) instructions: BTreeMap<String, u64>,
}

/// Reads a folder of one experiment, or a file of rows.
fn side(path: &Path) -> Result<Side> {
    let (file, folder) =
        if path.is_dir() { (path.join("records.csv"), Some(path)) } else { (path.to_path_buf(), path.parent()) };
    let machine = folder.map(|folder| folder.join(MACHINE)).filter(|path| path.is_file());
    let run = machine.map(|path| read_run_file(&path)).transpose()?;
    Ok(Side { run, rows: read_records(&file)?, instructions: instructions::read(&file)? })
}

/// Differences with which measurements may still be compared.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Across {
    /// Whether the machines may differ.
    pub machines: bool,
    /// Whether the builds may render other bits, so that their work is not known to be equal.
    pub revisions: bool,
}

/// Reads both measurements. Refuses those of two machines unless `across_machines`.
pub(super) fn sides(old: &Path, new: &Path, across_machines: bool) -> Result<[Side; 2]> {
    let both = [side(old)?, side(new)?];
    if let [Some(before), Some(after)] = [&both[0].run, &both[1].run]
        && !across_machines
    {
        let [then, now] = [before, after].map(|run| run.machine.line());
        if then != now {
            let problem = format!("was measured on another machine: {now}, not {then}");
            let error = InputError::new("new", new.display().to_string(), problem);
            return Err(error.allowed("--across-machines").into());
        }
    }
    Ok(both)
}

/// Refuses cells whose images have other bits in both measurements: more time for another image does not mean slower.
fn check_images([before, after]: &[Side; 2], new: &Path) -> Result<()> {
    let has_image = |row: &&Record| !row.checksum.is_empty();
    let old: BTreeMap<&str, &str> =
        before.rows.iter().filter(has_image).map(|row| (row.cell.as_str(), row.checksum.as_str())).collect();
    let is_other = |row: &&Record| old.get(row.cell.as_str()).is_some_and(|checksum| *checksum != row.checksum);
    let Some(row) = after.rows.iter().filter(has_image).find(is_other) else { return Ok(()) };
    let problem =
        format!("has another image than the old measurement in {}: the builds have different revisions", row.cell);
    let error = InputError::new("new", new.display().to_string(), problem);
    Err(error.allowed("builds whose images have the same bits, or --across-revisions").into())
}

/// Compares two measurements. `limit` is the share by which a cell may get slower, such as 0.03. Refuses measurements
/// that differ in more than `across` allows.
pub fn diff(old: &Path, new: &Path, limit: f64, across: Across) -> Result<Diff> {
    if !(limit.is_finite() && limit >= 0.0) {
        let error = InputError::new("fail-above", limit.to_string(), "is not a valid share");
        return Err(error.allowed("numbers from 0, such as 0.03 or 3%").into());
    }
    let sides = sides(old, new, across.machines)?;
    let both = |of: fn(&RunFile) -> bool| sides.iter().all(|side| side.run.as_ref().is_some_and(of));
    let pairing = match (both(|run| run.against.is_some()), both(|run| run.until.is_some())) {
        (false, _) => Pairing::None,
        (true, false) => Pairing::Paired,
        (true, true) => Pairing::Sequential,
    };
    let [before, after] = sides.each_ref().map(|side| times(&side.rows));
    let common: Vec<&String> = before.keys().filter(|cell| after.contains_key(*cell)).collect();
    if common.is_empty() {
        let problem = format!("has no cell in common with {}", old.display());
        return Err(InputError::new("new", new.display().to_string(), problem)
            .allowed("measurements of the same experiment at the same size")
            .into());
    }
    if !across.revisions {
        check_images(&sides, new)?;
    }
    let level = level_of(common.len());
    let cells = common.iter().filter_map(|cell| compared(cell, &before[*cell], &after[*cell], pairing, level, limit));
    let unmatched = [before.len() - common.len(), after.len() - common.len()];
    let warnings = sides.iter().flat_map(|side| &side.rows).map(|row| row.warnings.as_str());
    Ok(Diff {
        cells: cells.collect(),
        unmatched,
        paired: pairing != Pairing::None,
        sequential: pairing == Pairing::Sequential,
        stopped_by_times: pairing == Pairing::None
            && sides.iter().any(|side| side.run.as_ref().is_some_and(|run| run.until.is_some())),
        doubts: Doubts::of(warnings),
    })
}

/// The seconds of each cell, by repetition. Rows that failed have none.
fn times(rows: &[Record]) -> BTreeMap<String, BTreeMap<u32, f64>> {
    let mut times: BTreeMap<String, BTreeMap<u32, f64>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.error.is_empty()) {
        if let Some(seconds) = row.makespan_s.filter(|seconds| *seconds > 0.0 && seconds.is_finite()) {
            times.entry(row.cell.clone()).or_default().insert(row.repetition, seconds);
        }
    }
    times
}

/// Compares a cell's old and new seconds, given by repetition; `None` if there are none.
pub(super) fn compared(
    cell: &str,
    old: &BTreeMap<u32, f64>,
    new: &BTreeMap<u32, f64>,
    pairing: Pairing,
    level: f64,
    limit: f64,
) -> Option<CellDiff> {
    let values = |times: &BTreeMap<u32, f64>| times.values().copied().collect::<Vec<_>>();
    let (olds, news) = (values(old), values(new));
    let in_pairs = |interval: fn(&[f64], f64) -> Option<Interval>| {
        let ratios: Vec<f64> = old.iter().filter_map(|(at, old)| Some(new.get(at)? / old)).collect();
        median(&ratios).zip(interval(&ratios, level)).map(|(value, interval)| Estimate { value, interval })
    };
    let estimate: Option<Estimate> = match pairing {
        Pairing::None => rank_sum::ratio(&olds, &news, level),
        Pairing::Paired => in_pairs(median_interval),
        Pairing::Sequential => in_pairs(median_sequence),
    };
    let (old_s, new_s) = (median(&olds)?, median(&news)?);
    let interval = estimate.map(|estimate| estimate.interval).filter(|interval| interval.level >= level);
    let change = match interval {
        Some(interval) if interval.low > 1.0 + limit => Change::Slower,
        Some(interval) if interval.high < 1.0 => Change::Faster,
        Some(interval) if interval.low >= 1.0 - limit && interval.high <= 1.0 + limit => Change::Same,
        _ => Change::Undecided,
    };
    let ratio = estimate.map_or(new_s / old_s, |estimate| estimate.value);
    Some(CellDiff {
        cell: cell.to_string(),
        old_s,
        new_s,
        repetitions: [olds.len(), news.len()],
        ratio,
        interval,
        change,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use rand_pcg::Pcg64Dxsm;

    fn numbered(values: &[f64]) -> BTreeMap<u32, f64> {
        (0..).zip(values.iter().copied()).collect()
    }

    fn change(old: &[f64], new: &[f64], paired: bool) -> Change {
        let pairing = if paired { Pairing::Paired } else { Pairing::None };
        compared("cell", &numbered(old), &numbered(new), pairing, 0.95, 0.02).unwrap().change
    }

    const TIMES: [f64; 9] = [1.0, 1.001, 1.002, 0.999, 0.998, 1.003, 0.997, 1.0015, 0.9985];

    #[test]
    fn changes_are_found_and_equal_times_are_the_same() {
        for paired in [true, false] {
            assert_eq!(change(&TIMES, &TIMES, paired), Change::Same);
            assert_eq!(change(&TIMES, &TIMES.map(|time| 1.1 * time), paired), Change::Slower);
            assert_eq!(change(&TIMES, &TIMES.map(|time| 0.9 * time), paired), Change::Faster);
            // Certainly slower, but by less than the limit.
            assert_eq!(change(&TIMES, &TIMES.map(|time| 1.01 * time), paired), Change::Same);
            assert_eq!(
                change(&TIMES[..3], &TIMES[..3].iter().map(|time| 2.0 * time).collect::<Vec<_>>(), paired),
                Change::Undecided
            );
        }
        // With strong machine drift, pairs still decide, but other comparisons cannot.
        let drift = [1.0, 1.5, 2.0, 0.7, 1.2, 3.0, 0.5, 1.1, 2.2];
        assert_eq!(change(&drift, &drift.map(|time| 1.05 * time), true), Change::Slower);
        assert_eq!(change(&drift, &drift.map(|time| 1.05 * time), false), Change::Undecided);
    }

    #[test]
    fn a_single_time_decides_nothing() {
        assert_eq!(change(&[1.0], &[9.0], true), Change::Undecided);
        assert_eq!(change(&[1.0], &[9.0], false), Change::Undecided);
    }

    /// Simulates sweeps of six cells that run until each cell is decided, at most 200 times. Returns the number of
    /// sweeps with a slower cell and the mean repetitions of a cell. The new build's times are `factor` times the old
    /// ones. Both have noise of about 7 % with a heavy tail, and both rows of a pair share a drift.
    fn sweeps(count: u32, factor: f64, seed: u128) -> (u32, f64) {
        let mut generator = Pcg64Dxsm::new(seed, 3);
        let mut uniform = || ((generator.next_u64() >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0;
        let mut noise = || {
            let u = uniform();
            let disturbed = if uniform() < 0.05 { 1.5 } else { 1.0 };
            libm::exp(0.04 * libm::log(u / (1.0 - u))) * disturbed
        };
        let (mut slower, mut repetitions) = (0, 0);
        for _ in 0..count {
            let mut is_slower = false;
            for _ in 0..6 {
                let [mut old, mut new] = [BTreeMap::new(), BTreeMap::new()];
                let change = (0..200).find_map(|at| {
                    let drift = 1.0 + 0.5 * libm::sin(0.1 * f64::from(at));
                    old.insert(at, drift * noise());
                    new.insert(at, drift * noise() * factor);
                    let found = compared("cell", &old, &new, Pairing::Sequential, level_of(6), 0.02)?.change;
                    (found != Change::Undecided).then_some(found)
                });
                is_slower |= change == Some(Change::Slower);
                repetitions += old.len();
            }
            slower += u32::from(is_slower);
        }
        (slower, repetitions as f64 / f64::from(6 * count))
    }

    /// Two equal builds: at most 5 % of the sweeps, 10 of 200, find a slower cell; three standard deviations of that
    /// count are 9. Nearly all sweeps find a build that is 10 % slower.
    #[test]
    fn sweeps_that_go_on_until_they_know_are_seldom_wrong() {
        let ((equal, _), (slower, repetitions)) = (sweeps(200, 1.0, 1), sweeps(40, 1.1, 2));
        println!(
            "equal builds: {equal} of 200 fail; 10 % slower: {slower} of 40, after {repetitions:.0} repetitions a cell"
        );
        assert!(equal <= 19, "{equal}");
        assert!(slower >= 38, "{slower}");
    }
}
