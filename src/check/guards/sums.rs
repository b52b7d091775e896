//! Sums in double precision, block by block: a running sum in single precision stops growing.

use super::{Guard, Measured, Variant};
use crate::check::path::unguarded::f32_sum;
use crate::film::SampleSum;
use crate::math::Rgb;

pub(super) const GUARD: Guard = Guard {
    name: "sums of samples",
    error: "relative error of the sum of ten million samples of 0.7",
    operation: "a sample of three channels added",
    with: Variant { name: "f64, blocks of 16 and a tree", error: || error(tree(SAMPLES)), work: tree },
    without: Variant { name: "f32, one after the other", error: || error(running(SAMPLES)), work: running },
};

const SAMPLES: u64 = 10_000_000;
const VALUE: f64 = 0.7;

fn tree(count: u64) -> f64 {
    let mut sum = SampleSum::default();
    for _ in 0..count {
        sum.add(Rgb { r: VALUE, g: VALUE, b: VALUE });
    }
    sum.total().sum[0]
}

/// Sum and squares of three channels, as the film keeps them.
fn running(count: u64) -> f64 {
    let values = || (0..count).map(|_| VALUE);
    let squares = 3.0 * f32_sum(values().map(|value| value * value));
    let others = 2.0 * f32_sum(values());
    // What is not asked for must be computed all the same.
    f32_sum(values()) + 0.0 * (squares + others)
}

fn error(sum: f64) -> Measured {
    let exact = SAMPLES as f64 * VALUE;
    Measured::mean(&[((sum - exact) / exact).abs()])
}
