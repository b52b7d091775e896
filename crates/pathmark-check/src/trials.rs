//! Trials of a case: variant, expected result and found result.

use crate::analysis::z_test::{critical_value, sidak};
use serde::Serialize;
use std::fmt::{Debug, Display};

/// The probability that at least one test of a case, or of a section of closed forms, fails although everything is
/// right.
pub(super) const LEVEL: f64 = 1e-3;

/// Critical absolute score of each of `tests` tests together.
pub(super) fn critical(tests: usize) -> f64 {
    sidak(LEVEL, tests).and_then(critical_value).unwrap_or(f64::INFINITY)
}

/// Number of random inputs that a case may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// As many as all cases together can process in a minute or two.
    Quick,
    /// As many as the catalogue requires.
    Thorough,
}

/// One comparison of a case.
#[derive(Debug, Clone, Serialize)]
pub struct Trial {
    /// Subject of the comparison: a formula, a precision, an estimator, a strategy.
    pub variant: String,
    pub expected: String,
    pub found: String,
    /// Whether the actual result is right.
    pub passed: bool,
}

/// The outcome of a case.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome {
    pub trials: Vec<Trial>,
    /// Why the case, or a part of it, was skipped.
    pub skipped: Vec<String>,
}

impl Outcome {
    /// Whether all trials passed. A case without trials passes only if it states why.
    pub fn passed(&self) -> bool {
        self.trials.iter().all(|trial| trial.passed) && !(self.trials.is_empty() && self.skipped.is_empty())
    }

    pub fn failures(&self) -> impl Iterator<Item = &Trial> {
        self.trials.iter().filter(|trial| !trial.passed)
    }
}

/// Recorder for the trials of a running case.
pub struct Trials {
    effort: Effort,
    outcome: Outcome,
}

impl Trials {
    pub(super) fn new(effort: Effort) -> Self {
        Self { effort, outcome: Outcome { trials: Vec::new(), skipped: Vec::new() } }
    }

    pub(super) fn outcome(self) -> Outcome {
        self.outcome
    }

    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// Number of repetitions: the first number for a quick run, the second for a thorough one.
    pub fn times(&self, quick: u64, thorough: u64) -> u64 {
        match self.effort {
            Effort::Quick => quick,
            Effort::Thorough => thorough,
        }
    }

    /// Records a trial, and returns whether it passed.
    pub fn holds(
        &mut self,
        variant: impl Into<String>,
        expected: impl Display,
        found: impl Display,
        passed: bool,
    ) -> bool {
        let (variant, expected, found) = (variant.into(), expected.to_string(), found.to_string());
        self.outcome.trials.push(Trial { variant, expected, found, passed });
        passed
    }

    /// Requires a number to equal `expected` within the absolute `tolerance`. Infinities are close to themselves only,
    /// NaN to nothing.
    pub fn close(&mut self, variant: impl Into<String>, expected: f64, found: f64, tolerance: f64) -> bool {
        let passed = expected == found || (found - expected).abs() <= tolerance;
        self.holds(variant, format_args!("{expected:?} +- {tolerance:.1e}"), format_args!("{found:?}"), passed)
    }

    /// Requires a number, such as the largest error, to be at most `limit`. NaN fails.
    pub fn at_most(&mut self, variant: impl Into<String>, limit: f64, found: f64) -> bool {
        self.holds(variant, format_args!("at most {limit:?}"), format_args!("{found:?}"), found <= limit)
    }

    /// Requires a number to be at least `limit`. Used for errors of unguarded code, which hard inputs make large.
    pub fn at_least(&mut self, variant: impl Into<String>, limit: f64, found: f64) -> bool {
        self.holds(variant, format_args!("at least {limit:?}"), format_args!("{found:?}"), found >= limit)
    }

    /// Requires a value to equal `expected` exactly.
    pub fn same<T: PartialEq + Debug>(&mut self, variant: impl Into<String>, expected: T, found: T) -> bool {
        let pair = [expected, found];
        let [expected, found] = pair.each_ref().map(|value| format!("{value:?}"));
        self.holds(variant, expected, found, pair[0] == pair[1])
    }

    /// Requires that an event, named by `what`, happened in none of `of` tries.
    pub fn never(&mut self, variant: impl Into<String>, what: &str, count: u64, of: u64) -> bool {
        self.holds(variant, format_args!("0 {what}"), format_args!("{count} of {of}"), count == 0 && of > 0)
    }

    /// Requires the absolute value of a standardised deviation to be below the critical value.
    pub fn deviates_below(&mut self, variant: impl Into<String>, critical: f64, z: f64) -> bool {
        self.holds(variant, format_args!("|z| < {critical:.2}"), format_args!("z = {z:.2}"), z.abs() < critical)
    }

    /// Records why something was skipped.
    pub fn skip(&mut self, why: impl Into<String>) {
        self.outcome.skipped.push(why.into());
    }
}
