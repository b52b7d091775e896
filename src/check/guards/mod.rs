//! The price list of the guards: what each costs in time, and what goes wrong without it.
//!
//! A guard is extra work that keeps hard inputs correct; on easy inputs a simpler method would do. Both are tried on the same hard inputs against the exact
//! answer, and both are timed by turns on the same work. The simpler variants stand beside the cases (`unguarded.rs` of a section), and no
//! option leads to them.
//!
//! To add one: its file with a `GUARD`, and its line in [`GUARDS`].

mod epsilon;
mod fixed_order;
mod fresnel;
mod keys;
mod measured;
mod precision;
mod price_file;
mod report_guards;
mod self_hits;
mod sphere_formula;
mod sums;
mod visible_normals;
mod watertight;

pub use measured::Measured;
pub use price_file::{FILE, FOLDER, PriceRow, read_prices, write_prices};

use crate::measure::in_turns;
use std::hint::black_box;

/// All guards, in the order of a path's life.
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
/// Confidence of all intervals.
pub const LEVEL: f64 = 0.95;

/// What the program does, and what it could do instead.
pub struct Guard {
    /// What is guarded, in a few words.
    pub name: &'static str,
    /// What the error is and what it is measured on, with its unit.
    pub error: &'static str,
    /// What is timed.
    pub operation: &'static str,
    /// The program's way.
    pub with: Variant,
    /// The other.
    pub without: Variant,
}

/// One way to do something.
pub struct Variant {
    /// Its name.
    pub name: &'static str,
    /// Its error against the exact answer.
    pub error: fn() -> Measured,
    /// Does so many operations, and returns a number that depends on all of them, so that none can be left out.
    pub work: fn(u64) -> f64,
}

impl Guard {
    /// Measures errors and times.
    pub fn price(&self) -> PriceRow {
        let mut with = |count: u64| _ = black_box((self.with.work)(black_box(count)));
        let mut without = |count: u64| _ = black_box((self.without.work)(black_box(count)));
        let times = in_turns(ROUNDS, &mut with, &mut without, LEVEL);
        PriceRow::new(self, (self.with.error)(), (self.without.error)(), times)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every guard keeps the error well below what it is without: the intervals do not meet.
    #[test]
    fn guards_guard() {
        for guard in GUARDS {
            let (with, without) = ((guard.with.error)(), (guard.without.error)());
            assert!(with.high < without.low, "{}: {with:?} with, {without:?} without", guard.name);
            assert!(with.low <= with.value && with.value <= with.high, "{}: {with:?}", guard.name);
        }
    }

    /// Work is work: the number it returns is finite and differs with the amount.
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
