//! Sums in double precision, block by block: a running sum in single precision stops growing.

use super::{Guard, InRender, Measured, Often, Variant};
use crate::film::SampleSum;
use crate::math::Rgb;
use std::hint::black_box;

pub(super) const GUARD: Guard = Guard {
    name: "sums of samples",
    error: "relative error of the sum of ten million samples of 0.7",
    operation: "a sample of three channels added",
    in_render: InRender { scene: "cornell", often: Often::Sample(1.0) },
    with: Variant { name: "f64, blocks of 16 and a tree", error: || error(tree(SAMPLES)), work: tree },
    without: Variant { name: "f32, one after the other", error: || error(running(SAMPLES)), work: running },
};

const SAMPLES: u64 = 10_000_000;
const VALUE: f64 = 0.7;

fn tree(count: u64) -> f64 {
    let mut sum = SampleSum::default();
    for _ in 0..count {
        let value = black_box(VALUE);
        sum.add(Rgb { r: value, g: value, b: value });
    }
    sum.total().sum[0]
}

/// Sums and sums of squares of three channels, as in a film.
fn running(count: u64) -> f64 {
    let (mut sums, mut squares) = ([0.0_f32; 3], [0.0_f32; 3]);
    for _ in 0..count {
        let value = black_box(VALUE as f32);
        for (sum, square) in sums.iter_mut().zip(&mut squares) {
            *sum += value;
            *square += value * value;
        }
    }
    black_box((sums, squares));
    f64::from(sums[0])
}

fn error(sum: f64) -> Measured {
    let exact = SAMPLES as f64 * VALUE;
    Measured::mean(&[((sum - exact) / exact).abs()])
}
