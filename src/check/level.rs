//! How sure a case is: the level of its tests.

use crate::analysis::z_test::{critical_value, sidak};

/// The chance that any of a case's tests fails though all is right.
const LEVEL: f64 = 1e-3;

/// How large the score of one of so many tests may be, on either side.
pub(super) fn critical(tests: usize) -> f64 {
    sidak(LEVEL, tests).and_then(critical_value).unwrap_or(f64::INFINITY)
}
