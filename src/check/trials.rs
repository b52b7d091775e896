//! What a case tried, expected and found.

use serde::Serialize;
use std::fmt::{Debug, Display};

/// How many random inputs a case may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// As many as all cases together can try in a minute or two.
    Quick,
    /// As many as the catalogue asks for.
    Thorough,
}

/// One thing that was tried.
#[derive(Debug, Clone, Serialize)]
pub struct Trial {
    /// To what the case was applied: a formula, a precision, an estimator, a strategy.
    pub variant: String,
    /// What must come out.
    pub expected: String,
    /// What came out.
    pub found: String,
    /// Whether that is right.
    pub passed: bool,
}

/// What came of a case.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome {
    /// All that was tried.
    pub trials: Vec<Trial>,
    /// Why the case, or a part of it, was not tried here.
    pub skipped: Vec<String>,
}

impl Outcome {
    /// Whether all that was tried is right. A case of which nothing was tried has passed only if it says why.
    pub fn passed(&self) -> bool {
        self.trials.iter().all(|trial| trial.passed) && !(self.trials.is_empty() && self.skipped.is_empty())
    }

    /// What went wrong.
    pub fn failures(&self) -> impl Iterator<Item = &Trial> {
        self.trials.iter().filter(|trial| !trial.passed)
    }
}

/// What a case writes down as it goes.
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

    /// How many times to try: the first number quickly, the second thoroughly.
    pub fn times(&self, quick: u64, thorough: u64) -> u64 {
        match self.effort {
            Effort::Quick => quick,
            Effort::Thorough => thorough,
        }
    }

    /// Writes down whether something holds.
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

    /// A number that must be `expected` within the absolute `tolerance`. Infinities are close to themselves only, NaN to nothing.
    pub fn close(&mut self, variant: impl Into<String>, expected: f64, found: f64, tolerance: f64) -> bool {
        let passed = expected == found || (found - expected).abs() <= tolerance;
        self.holds(variant, format_args!("{expected:?} +- {tolerance:.1e}"), format_args!("{found:?}"), passed)
    }

    /// A value that must be exactly what is expected.
    pub fn same<T: PartialEq + Debug>(&mut self, variant: impl Into<String>, expected: &T, found: &T) -> bool {
        let passed = expected == found;
        self.holds(variant, format_args!("{expected:?}"), format_args!("{found:?}"), passed)
    }

    /// Something, named by `what`, that must not have happened in any of `of` tries.
    pub fn never(&mut self, variant: impl Into<String>, what: &str, count: u64, of: u64) -> bool {
        self.holds(variant, format_args!("0 {what}"), format_args!("{count} of {of}"), count == 0 && of > 0)
    }

    /// A standardised deviation that must stay below the critical value, on either side.
    pub fn deviates_below(&mut self, variant: impl Into<String>, critical: f64, z: f64) -> bool {
        self.holds(variant, format_args!("|z| < {critical:.2}"), format_args!("z = {z:.2}"), z.abs() < critical)
    }

    /// Says why something was not tried here.
    pub fn skip(&mut self, why: impl Into<String>) {
        self.outcome.skipped.push(why.into());
    }
}
