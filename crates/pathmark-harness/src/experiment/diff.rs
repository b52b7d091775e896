//! Comparison of two measurements of the same cells: which cells got slower, and which are lost?
//!
//! Rows of one sweep in turns (`run --baseline`) give a ratio for each adjacent pair, or in older rows for each repetition; other rows give the ratios of all pairs
//! of an old and a new time, with an interval that allows for their autocorrelation. If repetitions in pairs had a goal
//! (`run --until`), the intervals hold at every look. All intervals of a comparison, over all of its experiments, hold
//! together with 95 % confidence (Bonferroni).

use super::run_file::RunFile;
use super::sides::{Compared, Lost, Side, check_images, sides};
use crate::analysis::adjacent_pairs::{by_process, paired_ratio};
use crate::analysis::confidence_sequence::median_sequence;
use crate::analysis::quantile::{median, median_interval};
use crate::analysis::rank_sum::RankSum;
use crate::analysis::ranking::{Turn, ratios_in_pairs};
use crate::analysis::{Estimate, Interval};
use crate::error::{InputError, Result};
use crate::measure::{Record, TimingConcerns};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// The probability that any interval of a comparison misses.
const MISS: f64 = 0.05;

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
    pub fn name(self) -> &'static str {
        match self {
            Self::Slower => "slower",
            Self::Faster => "faster",
            Self::Same => "same",
            Self::Undecided => "undecided",
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CellDiff {
    pub cell: String,
    pub old_s: f64,
    pub new_s: f64,
    /// Numbers of times that were compared, old and new.
    pub repetitions: [usize; 2],
    /// New over old.
    pub ratio: f64,
    pub interval: Option<Interval>,
    pub change: Change,
}

/// Seconds by repetition, and by pair where a repetition is a process of adjacent pairs.
pub(super) type Times = BTreeMap<Turn, f64>;

/// The repetition and pair of a row.
pub(super) fn turn(record: &Record) -> Turn {
    (record.repetition, record.pair)
}

/// The median time of each process.
pub(super) fn of_processes(times: &Times) -> Times {
    let mut processes: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
    for ((process, _), seconds) in times {
        processes.entry(*process).or_default().push(*seconds);
    }
    processes.into_iter().filter_map(|(process, own)| Some(((process, None), median(&own)?))).collect()
}

/// Whether the times were measured in adjacent pairs.
pub(super) fn is_in_pairs(times: &Times) -> bool {
    times.keys().any(|(_, pair)| pair.is_some())
}

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
    1.0 - MISS / cells.max(1) as f64
}

pub(super) struct Judge {
    level: f64,
    /// The share by which a cell may get slower.
    limit: f64,
    unpaired: RankSum,
}

impl Judge {
    /// A judge of `cells` cells, whose intervals hold together.
    pub(super) fn new(cells: usize, limit: f64) -> Self {
        let level = level_of(cells);
        // Half of the misses are left for the bound on the autocorrelation.
        Self { level, limit, unpaired: RankSum::new(0.5 + 0.5 * level) }
    }

    pub(super) fn compare(&self, cell: &str, pairing: Pairing, old: &Times, new: &Times) -> Option<CellDiff> {
        let values = |times: &Times| times.values().copied().collect::<Vec<_>>();
        let (olds, news) = (values(old), values(new));
        let in_pairs = |interval: fn(&[f64], f64) -> Option<Interval>| {
            let processes = by_process(ratios_in_pairs(new, old));
            let ratios: Vec<f64> = processes.iter().filter_map(|own| median(own)).collect();
            median(&ratios).zip(interval(&ratios, self.level)).map(|(value, interval)| Estimate { value, interval })
        };
        let estimate: Option<Estimate> = match pairing {
            Pairing::Paired if is_in_pairs(new) => {
                paired_ratio(&by_process(ratios_in_pairs(new, old)), self.level).map(|found| found.ratio)
            }
            Pairing::None => self.unpaired.ratio_of_series(&olds, &news),
            Pairing::Paired => in_pairs(median_interval),
            Pairing::Sequential => in_pairs(median_sequence),
        };
        let (old_s, new_s) = (median(&olds)?, median(&news)?);
        let interval = estimate.map(|estimate| estimate.interval).filter(|interval| interval.level >= self.level);
        let change = match interval {
            Some(interval) if interval.low > 1.0 + self.limit => Change::Slower,
            Some(interval) if interval.high < 1.0 => Change::Faster,
            Some(interval) if interval.low >= 1.0 - self.limit && interval.high <= 1.0 + self.limit => Change::Same,
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
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diff {
    pub cells: Vec<CellDiff>,
    #[serde(flatten)]
    pub lost: Lost,
    /// Numbers of cells with times that have none in the other measurement: of the old and of the new one.
    pub unmatched: [usize; 2],
    pub paired: bool,
    /// Whether repetitions had a goal, and the intervals allow for that.
    pub sequential: bool,
    /// Whether repetitions had a goal, and the intervals do not allow for that.
    #[serde(skip)]
    pub stopped_by_times: bool,
    #[serde(rename = "doubted_rows")]
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

/// The times of each cell.
pub(super) type Cells = BTreeMap<String, Times>;

/// Rows that failed have no time.
pub(super) fn times(rows: &[Record]) -> Cells {
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use rand_pcg::Pcg64Dxsm;

    fn numbered(values: &[f64]) -> Times {
        (0..).map(|at| (at, None)).zip(values.iter().copied()).collect()
    }

    fn change(old: &[f64], new: &[f64], paired: bool) -> Change {
        let pairing = if paired { Pairing::Paired } else { Pairing::None };
        Judge::new(1, 0.02).compare("cell", pairing, &numbered(old), &numbered(new)).unwrap().change
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

    /// Simulates sweeps of six cells that run until each cell is decided, at most 100 times. Returns the number of
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
        let (judge, mut slower, mut repetitions) = (Judge::new(6, 0.02), 0, 0);
        for _ in 0..count {
            let mut is_slower = false;
            for _ in 0..6 {
                let [mut old, mut new] = [BTreeMap::new(), BTreeMap::new()];
                let change = (0..100).find_map(|at| {
                    let drift = 1.0 + 0.5 * libm::sin(0.1 * f64::from(at));
                    old.insert((at, None), drift * noise());
                    new.insert((at, None), drift * noise() * factor);
                    let found = judge.compare("cell", Pairing::Sequential, &old, &new)?.change;
                    (found != Change::Undecided).then_some(found)
                });
                is_slower |= change == Some(Change::Slower);
                repetitions += old.len();
            }
            slower += u32::from(is_slower);
        }
        (slower, repetitions as f64 / f64::from(6 * count))
    }

    /// Two equal builds: at most 5 % of the sweeps, 5 of 100, find a slower cell; three standard deviations of that
    /// count are 6.5. Nearly all sweeps find a build that is 10 % slower.
    #[test]
    fn sweeps_that_go_on_until_they_know_are_seldom_wrong() {
        let ((equal, _), (slower, repetitions)) = (sweeps(100, 1.0, 1), sweeps(20, 1.1, 2));
        println!(
            "equal builds: {equal} of 100 fail; 10 % slower: {slower} of 20, after {repetitions:.0} repetitions a cell"
        );
        assert!(equal <= 11, "{equal}");
        assert!(slower >= 18, "{slower}");
    }

    /// Simulates comparisons of two sweeps of `cells` cells in `count` repetitions. Times scatter by 1 %, and each depends
    /// on the one before it: their logarithms are autoregressive with the correlation `rho`. Returns how many of `runs`
    /// comparisons find a difference in any cell.
    fn verdicts(runs: u32, cells: usize, count: u32, rho: f64, factor: f64) -> usize {
        let (judge, mut generator) = (Judge::new(cells, 0.0), Pcg64Dxsm::new(29, 5));
        let mut uniform = || ((generator.next_u64() >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0;
        // G. E. P. Box and M. E. Muller (1958).
        let mut normal = || (-2.0 * libm::log(uniform())).sqrt() * libm::cos(std::f64::consts::TAU * uniform());
        let mut series = |factor: f64| -> Times {
            let mut state = normal();
            let mut step = |at| {
                state = rho * state + (1.0 - rho * rho).sqrt() * normal();
                ((at, None), factor * libm::exp(0.01 * state))
            };
            (0..count).map(&mut step).collect()
        };
        let mut is_other = |_| {
            let found = judge.compare("cell", Pairing::None, &series(1.0), &series(factor));
            found.is_some_and(|found| [Change::Slower, Change::Faster].contains(&found.change))
        };
        (0..runs).filter(|_| (0..cells).map(&mut is_other).fold(false, |any, is_other| any | is_other)).count()
    }

    /// Two sweeps of one build have a level of 5 %: at most 20 of 400 comparisons find a difference, and three standard
    /// deviations of that count are 13. Nearly all of 40 comparisons find a difference of ten times the noise.
    #[test]
    fn times_that_follow_their_neighbours_make_no_difference() {
        for (cells, count) in [(1, 6), (1, 30), (6, 10)] {
            for rho in [0.0, 0.3, 0.7] {
                let wrong = verdicts(400, cells, count, rho, 1.0);
                println!("{cells} cells, {count} repetitions, correlation {rho}: {wrong} of 400 differ");
                assert!(wrong <= 33, "{cells} cells, {count} repetitions, correlation {rho}: {wrong}");
            }
        }
        for (cells, count, rho) in [(1, 10, 0.0), (1, 30, 0.7), (6, 10, 0.0), (6, 10, 0.3)] {
            let right = verdicts(40, cells, count, rho, 1.1);
            println!("{cells} cells, {count} repetitions, correlation {rho}: {right} of 40 find 10 %");
            assert!(right >= 36, "{cells} cells, {count} repetitions, correlation {rho}: {right}");
        }
    }
}
