//! Repetitions that go on until two builds are told apart: `run EXPERIMENT --against OLD --until 3%`.
//!
//! A cell is decided when the interval of its ratio of times lies above 1 plus the limit, below 1, or within the limit of 1. Intervals hold at every
//! look ([`crate::analysis::confidence_sequence`]), so stopping by them does not make them wrong. What is decided is left out of later repetitions.

use super::diff::{Change, Pairing, compared, level_of, parse_share};
use crate::error::{InputError, Result};
use crate::measure::Record;
use std::collections::{BTreeMap, HashMap};
use std::time::Duration;

/// As many repetitions as a comparison takes, if nobody says how many it may.
pub const MOST_REPETITIONS: u32 = 200;

/// When to stop.
#[derive(Debug, Clone, PartialEq)]
pub struct Until {
    /// The share by which a cell may get slower.
    pub limit: f64,
    /// The limit as the user gave it.
    pub text: String,
    /// No repetition begins later than that.
    pub within: Option<Duration>,
}

impl Until {
    /// From what stands on the command line: `3%` or `0.03`, and `60s`.
    pub fn parse(limit: &str, within: Option<&str>) -> Result<Self> {
        let length = |text: &str| -> Result<Duration> {
            let wrong = || InputError::new("within", text, "is no length of time").allowed("60s, or 2min");
            Ok(humantime::parse_duration(text).map_err(|_| wrong())?)
        };
        let within = within.map(length).transpose()?;
        let share = parse_share("until", limit)?;
        if share <= 0.0 {
            let problem = "would never be decided: two equal builds differ by less than nothing";
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
pub(super) struct Decisions(HashMap<String, [BTreeMap<u32, f64>; 2]>);

impl Decisions {
    /// Knows a row of the old build or of the new one.
    pub(super) fn note(&mut self, record: &Record, is_new: bool) {
        if let Some(seconds) = record.makespan_s.filter(|seconds| record.error.is_empty() && *seconds > 0.0) {
            let times = self.0.entry(record.cell.clone()).or_default();
            times[usize::from(is_new)].insert(record.repetition, seconds);
        }
    }

    /// Whether a cell, one of so many that are compared, is decided.
    pub(super) fn is_decided(&self, cell: &str, cells: usize, limit: f64) -> bool {
        let Some([old, new]) = self.0.get(cell) else { return false };
        let found = compared(cell, old, new, Pairing::Sequential, level_of(cells), limit);
        found.is_some_and(|found| found.change != Change::Undecided)
    }
}
