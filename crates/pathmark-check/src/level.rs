//! Significance level of the tests of a case.

use crate::analysis::z_test::{critical_value, sidak};

/// The probability that at least one test of a case fails although everything is right.
const LEVEL: f64 = 1e-3;

/// Critical absolute score of each of `tests` tests together.
pub(super) fn critical(tests: usize) -> f64 {
    sidak(LEVEL, tests).and_then(critical_value).unwrap_or(f64::INFINITY)
}
