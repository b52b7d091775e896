//! The price list of the guards: the time that each costs, and the error without it.
//!
//! A guard is extra work that keeps hard inputs correct; on easy inputs a simpler method would do. Both methods are
//! compared with the exact answer on the same hard inputs, and timed in turns on the same work. The simpler variants
//! stand beside the cases (`unguarded.rs` of a section). No option of the program selects them.
//!
//! To add one, write its file with a `GUARD`, and add its line to [`GUARDS`].

mod epsilon;
mod fixed_order;
mod fresnel;
mod keys;
mod measured;
mod precision;
mod report_guards;
mod self_hits;
mod sphere_formula;
mod sums;
mod visible_normals;
mod watertight;

pub use measured::Measured;

use crate::guard_prices::{LEVEL, PriceRow};
use crate::measure::{Interleaved, interleaved};
use std::hint::black_box;

/// All guards, in the order in which a path meets them.
pub static GUARDS: &[Guard] = &[
    precision::GUARD,
    sphere_formula::GUARD,
    watertight::GUARD,
    epsilon::GUARD,
    self_hits::GUARD,
    fresnel::GUARD,
    visible_normals::GUARD,
    report_guards::GUARD,
    keys::GUARD,
    sums::GUARD,
    fixed_order::GUARD,
];

/// Rounds in which both variants are timed.
const ROUNDS: usize = 31;
/// A method of the program and a simpler alternative.
pub struct Guard {
    /// Short name of the guarded property.
    pub name: &'static str,
    /// Definition of the error, its inputs and its unit.
    pub error: &'static str,
    /// The operation that is timed.
    pub operation: &'static str,
    /// The program's method.
    pub with: Variant,
    /// The simpler alternative.
    pub without: Variant,
}

/// One of the two methods.
pub struct Variant {
    pub name: &'static str,
    /// Its error against the exact answer.
    pub error: fn() -> Measured,
    /// Runs so many operations. Returns a number that depends on all of them, so that the compiler cannot omit any.
    pub work: fn(u64) -> f64,
}

impl Guard {
    /// Measures errors and times.
    pub fn price(&self) -> PriceRow {
        let mut with = |count: u64| _ = black_box((self.with.work)(black_box(count)));
        let mut without = |count: u64| _ = black_box((self.without.work)(black_box(count)));
        let times = interleaved(ROUNDS, &mut with, &mut without, LEVEL);
        self.row((self.with.error)(), (self.without.error)(), times)
    }

    fn row(&self, with: Measured, without: Measured, times: Option<Interleaved>) -> PriceRow {
        PriceRow {
            guard: self.name.to_string(),
            error: self.error.to_string(),
            with: self.with.name.to_string(),
            without: self.without.name.to_string(),
            error_with: with.value,
            error_with_low: with.low,
            error_with_high: with.high,
            error_without: without.value,
            error_without_low: without.low,
            error_without_high: without.high,
            operation: self.operation.to_string(),
            ns_with: times.map(|times| times.first_ns),
            ns_without: times.map(|times| times.second_ns),
            time_ratio: times.map(|times| times.ratio.value),
            time_ratio_low: times.map(|times| times.ratio.interval.low),
            time_ratio_high: times.map(|times| times.ratio.interval.high),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every guard keeps the error well below the error without it: the intervals do not overlap.
    #[test]
    fn guards_guard() {
        for guard in GUARDS {
            let (with, without) = ((guard.with.error)(), (guard.without.error)());
            assert!(with.high < without.low, "{}: {with:?} with, {without:?} without", guard.name);
            assert!(with.low <= with.value && with.value <= with.high, "{}: {with:?}", guard.name);
        }
    }

    /// No operation is optimised away: the returned number is finite and depends on their count.
    #[test]
    fn work_is_not_left_out() {
        for guard in GUARDS {
            for variant in [&guard.with, &guard.without] {
                let [few, many] = [64, 4096].map(variant.work);
                assert!(
                    few.is_finite() && many.is_finite() && few.to_bits() != many.to_bits(),
                    "{}: {}",
                    guard.name,
                    variant.name
                );
            }
        }
    }
}
