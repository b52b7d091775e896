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
mod in_render;
mod keys;
mod precision;
mod report_guards;
mod sphere_formula;
mod sums;
mod visible_normals;
mod watertight;

pub use in_render::{GuardTimes, InRender, Often, RenderTime};

use crate::analysis::adjacent_pairs::paired_ratio;
use crate::analysis::mean::t_interval;
use crate::analysis::quantile::median;
use crate::error::{Error, Result};
use crate::guard_prices::{LEVEL, PriceRow};
use crate::measure::interleaved;
use serde::{Deserialize, Serialize};
use std::hint::black_box;

/// All guards, in the order in which a path meets them.
pub static GUARDS: &[Guard] = &[
    precision::GUARD,
    sphere_formula::GUARD,
    watertight::GUARD,
    epsilon::SMALL,
    epsilon::HUGE,
    fresnel::GUARD,
    visible_normals::GUARD,
    report_guards::GUARD,
    keys::GUARD,
    sums::GUARD,
    fixed_order::GUARD,
];

/// Rounds in which a process times both variants.
const ROUNDS: usize = 9;

/// A method of the program and a simpler alternative.
pub struct Guard {
    /// Short name of the guarded property.
    pub name: &'static str,
    /// Definition of the error, its inputs and its unit.
    pub error: &'static str,
    /// The operation that is timed.
    pub operation: &'static str,
    /// A render that contains the operation.
    pub in_render: InRender,
    /// The program's method.
    pub with: Variant,
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

/// A method whose error and work are measured by a function of each kind.
macro_rules! variant {
    ($name:literal, $error:ident, $work:ident, $method:expr) => {
        $crate::guards::Variant { name: $name, error: || $error($method), work: |count| $work(count, $method) }
    };
}
use variant;

impl Guard {
    /// The times of both methods in this process, and of a render beside them.
    pub fn times(&self) -> Result<GuardTimes> {
        let mut with = |count: u64| _ = black_box((self.with.work)(black_box(count)));
        let mut without = |count: u64| _ = black_box((self.without.work)(black_box(count)));
        let operation = interleaved(ROUNDS, &mut with, &mut without)
            .ok_or_else(|| Error::Check(format!("the guard {} was not timed", self.name)))?;
        Ok(GuardTimes { operation, render: self.in_render.time()? })
    }

    /// Measures the errors, and adds the times of several processes.
    pub fn price(&self, processes: &[GuardTimes]) -> PriceRow {
        let (with, without) = ((self.with.error)(), (self.without.error)());
        let of = |value: fn(&GuardTimes) -> f64| processes.iter().map(value).collect::<Vec<f64>>();
        let pairs: Vec<Vec<f64>> = processes.iter().map(|own| own.operation.ratios.clone()).collect();
        let ratio = paired_ratio(&pairs, LEVEL).map(|found| found.ratio);
        let share = t_interval(&of(GuardTimes::share), LEVEL);
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
            ns_with: median(&of(|own| own.operation.first_ns)),
            ns_without: median(&of(|own| own.operation.second_ns)),
            time_ratio: ratio.map(|ratio| ratio.value),
            time_ratio_low: ratio.map(|ratio| ratio.interval.low),
            time_ratio_high: ratio.map(|ratio| ratio.interval.high),
            scene: self.in_render.scene.to_string(),
            often: self.in_render.often.in_words(),
            operations: median(&of(|own| own.render.operations)),
            render_ns: median(&of(|own| own.render.sample_ns)),
            share: share.map(|share| share.value),
            share_low: share.map(|share| share.interval.low),
            share_high: share.map(|share| share.interval.high),
            processes: Some(processes.len()),
        }
    }
}

/// A number with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

/// Normal quantile of a two-sided interval of 95 %.
const Z: f64 = 1.959_963_984_540_054;

impl Measured {
    /// The mean of some numbers. Equal numbers give an interval of width zero.
    fn mean(values: &[f64]) -> Self {
        let exactly = |value| Self { value, low: value, high: value };
        t_interval(values, LEVEL).map_or_else(
            || exactly(values.first().copied().unwrap_or(f64::NAN)),
            |mean| Self { value: mean.value, low: mean.interval.low.max(0.0), high: mean.interval.high },
        )
    }

    /// The share of `count` in `all`, with the interval of E. B. Wilson, "Probable inference, the law of succession,
    /// and statistical inference", Journal of the American Statistical Association 22 (1927). A count of zero has a
    /// positive upper end there.
    fn share(count: u64, all: u64) -> Self {
        let (n, value) = (all as f64, count as f64 / all as f64);
        let scale = 1.0 + Z * Z / n;
        let centre = (value + Z * Z / (2.0 * n)) / scale;
        let half_width = Z / scale * (value * (1.0 - value) / n + Z * Z / (4.0 * n * n)).sqrt();
        let low = if count == 0 { 0.0 } else { centre - half_width };
        Self { value, low, high: if count == all { 1.0 } else { centre + half_width } }
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

    #[test]
    fn shares() {
        // Wilson's interval from tables: 0.0552 to 0.1744 for 10 in 100, 0 to 0.0370 for none in 100.
        let ten = Measured::share(10, 100);
        assert!((ten.low - 0.0552).abs() < 1e-4 && (ten.high - 0.1744).abs() < 1e-4, "{ten:?}");
        let none = Measured::share(0, 100);
        assert!(none.low == 0.0 && (none.high - 0.0370).abs() < 1e-4, "{none:?}");
    }

    #[test]
    fn means() {
        assert_eq!(Measured::mean(&[2.0, 2.0]), Measured { value: 2.0, low: 2.0, high: 2.0 });
        // Student's t for 2 degrees of freedom is 4.3027; s = 1.
        let mean = Measured::mean(&[4.0, 5.0, 6.0]);
        assert!((mean.high - (5.0 + 4.3027 / 3.0_f64.sqrt())).abs() < 1e-3, "{mean:?}");
    }
}
