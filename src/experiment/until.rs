//! Repetitions that go on until enough is known: `run EXPERIMENT --until 3%`, or `repetitions = { until = "3 %" }` in its file.
//!
//! With another build beside this one (`--against OLD`), a cell is decided when the interval of its ratio of times lies above 1 plus the limit, below 1,
//! or within the limit of 1. Otherwise it is decided when its speedup over the serial run of its image, or its time where there is no serial run, is
//! known to within the limit. Intervals hold at every look ([`crate::analysis::confidence_sequence`]), so stopping by them does not make them wrong.
//! What is decided is left out of later repetitions; serial runs go on beside the cells that are compared with them.

use super::diff::{Change, Pairing, compared, level_of, parse_share};
use crate::analysis::Interval;
use crate::analysis::confidence_sequence::median_sequence;
use crate::analysis::quantile::median;
use crate::error::{InputError, Result};
use crate::measure::Record;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::time::Duration;

/// Confidence of each interval of an experiment, as its figures have it.
const LEVEL: f64 = 0.95;

/// As many repetitions as a comparison takes, if nobody says how many it may.
pub const MOST_REPETITIONS: u32 = 200;

/// When to stop.
#[derive(Debug, Clone, PartialEq)]
pub struct Until {
    /// The share by which a cell may get slower, or to which what it is compared by is to be known.
    pub limit: f64,
    /// The limit as the user gave it.
    pub text: String,
    /// No repetition begins later than that.
    pub within: Option<Duration>,
}

impl Until {
    /// From text: `3%` or `0.03`, and `60s`.
    pub fn parse(limit: &str, within: Option<&str>) -> Result<Self> {
        let length = |text: &str| -> Result<Duration> {
            let wrong = || InputError::new("within", text, "is no length of time").allowed("60s, or 2min");
            Ok(humantime::parse_duration(text).map_err(|_| wrong())?)
        };
        let within = within.map(length).transpose()?;
        let share = parse_share("until", limit)?;
        if share <= 0.0 {
            let problem = "would never be reached: no interval of times has no width";
            return Err(InputError::new("until", limit, problem).allowed("a share above 0, as 3%").into());
        }
        Ok(Self { limit: share, text: limit.to_string(), within })
    }

    /// Whether no repetition may begin any more.
    pub(super) fn is_over(&self, elapsed: Duration) -> bool {
        self.within.is_some_and(|within| elapsed >= within)
    }
}

/// The seconds of both builds so far, by cell and repetition.
#[derive(Default)]
pub(super) struct Decisions {
    times: HashMap<String, [BTreeMap<u32, f64>; 2]>,
    /// Cells of which a row has no time: they failed, or what they need is not on this machine.
    without_time: HashSet<String>,
}

impl Decisions {
    /// Knows a row of the old build or of the new one.
    pub(super) fn note(&mut self, record: &Record, is_new: bool) {
        if let Some(seconds) = record.makespan_s.filter(|seconds| record.error.is_empty() && *seconds > 0.0) {
            let times = self.times.entry(record.cell.clone()).or_default();
            times[usize::from(is_new)].insert(record.repetition, seconds);
        } else {
            self.without_time.insert(record.cell.clone());
        }
    }

    /// Whether a cell, one of so many that are compared, is decided.
    pub(super) fn is_decided(&self, cell: &str, cells: usize, limit: f64) -> bool {
        let Some([old, new]) = self.times.get(cell) else { return false };
        let found = compared(cell, old, new, Pairing::Sequential, level_of(cells), limit);
        found.is_some_and(|found| found.change != Change::Undecided)
    }

    /// Whether a cell's speedup over the serial run beside it, or its time where there is none, is known to within the limit to either side. More
    /// repetitions of a cell without a time would not tell more.
    pub(super) fn is_known(&self, cell: &str, serial: Option<&str>, limit: f64) -> bool {
        if self.without_time.contains(cell) {
            return true;
        }
        let times = |cell: &str| self.times.get(cell).map(|[_, new]| new);
        let Some(own) = times(cell) else { return false };
        let values: Vec<f64> = match serial {
            None => own.values().copied().collect(),
            Some(serial) => {
                let Some(serial) = times(serial) else { return self.without_time.contains(serial) };
                own.iter().filter_map(|(repetition, own)| Some(serial.get(repetition)? / own)).collect()
            }
        };
        let width = |(middle, interval): (f64, Interval)| (interval.high - interval.low) / middle;
        median(&values).zip(median_sequence(&values, LEVEL)).is_some_and(|found| width(found) <= 2.0 * limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noted(cells: &[(&str, &[f64])]) -> Decisions {
        let mut decisions = Decisions::default();
        for (cell, times) in cells {
            for (repetition, seconds) in (0..).zip(*times) {
                let makespan_s = Some(*seconds).filter(|seconds| seconds.is_finite());
                let record = Record { cell: (*cell).to_string(), repetition, makespan_s, ..Record::default() };
                decisions.note(&record, true);
            }
        }
        decisions
    }

    /// Eight values are the fewest that an interval at every look has: from the least to the largest of them.
    #[test]
    fn what_is_known_is_known_to_within_the_limit() {
        let (drift, twice) = ([1.0, 2.0, 1.0, 3.0, 1.0, 2.0, 1.0, 2.0], [2.0, 4.0, 2.0, 6.0, 2.0, 4.0, 2.0, 4.0]);
        let seven = &twice[..7];
        let decisions = noted(&[("serial", &drift), ("steady", &twice), ("seven", seven), ("alone", &drift)]);
        assert!(decisions.is_known("steady", Some("serial"), 0.001), "drift falls on both");
        assert!(!decisions.is_known("seven", Some("serial"), 0.9), "seven values have no interval");
        // From 1 to 3 around a median of 1.5: 2 is 1.33 times that, two thirds to either side.
        assert!(decisions.is_known("alone", None, 0.667) && !decisions.is_known("alone", None, 0.66));
        assert!(!decisions.is_known("absent", None, 0.9) && !decisions.is_known("steady", Some("absent"), 0.9));
    }

    #[test]
    fn a_cell_without_a_time_is_not_waited_for() {
        let decisions = noted(&[("failed", &[f64::NAN]), ("sound", &[1.0; 9])]);
        assert!(decisions.is_known("failed", None, 0.01) && decisions.is_known("sound", None, 0.01));
        assert!(decisions.is_known("sound", Some("failed"), 0.01));
    }
}
