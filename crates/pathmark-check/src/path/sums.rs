//! Sums and variances of many samples.

use super::unguarded::{f32_sum, f64_sum, kahan_sum, variance_by_squares};
use crate::Trials;
use crate::analysis::mean::Moments;
use crate::double_double::{Dd, two_sum};
use crate::film::{PixelSum, SAMPLE_BLOCK, SampleSum};
use crate::math::Rgb;
use rand::Rng;
use rand_pcg::Pcg64Mcg;
use std::iter::repeat_n;

/// A pixel's sum, as a film computes it.
fn film_sum(values: impl Iterator<Item = f64>) -> PixelSum {
    let mut sum = SampleSum::default();
    values.for_each(|value| sum.add(Rgb::WHITE * value));
    sum.total()
}

/// The sum as two f64, of which the second holds the digits lost by the first (T. J. Dekker, "A floating-point
/// technique for extending the available precision", Numerische Mathematik 18, 1971; two-sum by D. E. Knuth).
fn double_double_sum(values: impl Iterator<Item = f64>) -> f64 {
    let add = |Dd(high, low), value| {
        let Dd(sum, lost) = two_sum(high, value);
        two_sum(sum, low + lost)
    };
    let Dd(high, low) = values.fold(Dd(0.0, 0.0), add);
    high + low
}

/// Equal samples. A running sum in f32 is off by 1 % after a million samples and by 10 % after ten million; a sum of
/// ones stops at 2^24.
pub(super) fn long_sums(trials: &mut Trials) {
    for n in [1_000_000, trials.times(3_000_000, 100_000_000) as u32] {
        let exact = 0.7 * f64::from(n);
        let found = film_sum(repeat_n(0.7, n as usize));
        trials.close(format!("{n} samples of 0.7: sum"), exact, found.sum[0], 1e-14 * exact);
        trials.close(format!("{n} samples of 0.7: mean"), 0.7, found.mean()[1], 1e-14);
        trials.same(format!("{n} samples: number"), n, found.count);
    }
    let off = |found: f64, n: f64| found / (0.7 * n) - 1.0;
    trials.close("unguarded, f32, 1e6 samples: off by", -0.010, off(f32_sum(repeat_n(0.7, 1_000_000)), 1e6), 5e-4);
    trials.close("unguarded, f32, 1e7 samples: off by", -0.095, off(f32_sum(repeat_n(0.7, 10_000_000)), 1e7), 1e-3);
    trials.same("unguarded, f32, 2e7 ones", 16_777_216.0, f32_sum(repeat_n(1.0, 20_000_000)));
    let plain = off(f64_sum(repeat_n(0.7, 1_000_000)), 1e6).abs();
    trials.holds("unguarded, f64, 1e6 samples: off by", "1e-14 to 1e-9", plain, (1e-14..1e-9).contains(&plain));
}

/// 4, 7, 13 and 16 have the variance 22.5, or 30 as a sample, whatever offset is added. A film keeps sums of squares.
/// They are accurate for samples that differ by at least a millionth of their size, and never give a negative
/// variance.
pub(super) fn variance(trials: &mut Trials) {
    for offset in [0.0, 1e8, 1e9] {
        let values = [4.0, 7.0, 13.0, 16.0].map(|value| value + offset);
        let moments = Moments::of(&values);
        let found = (moments.population_variance(), moments.sample_variance());
        trials.same(format!("beside {offset:?}"), (Some(22.5), Some(30.0)), found);
    }
    let beside = |offset: f64| variance_by_squares(&[4.0, 7.0, 13.0, 16.0].map(|value| value + offset));
    trials.same("unguarded, beside 1e8", 22.0, beside(1e8));
    trials.same("unguarded, beside 1e9", -128.0, beside(1e9));

    for (scale, tolerance) in [(1.0, 1e-14), (1e-3, 1e-10), (1e-6, 1e-4)] {
        let found = film_sum([4.0, 7.0, 13.0, 16.0].into_iter().map(|value| 1.0 + scale * value)).variance();
        let exact = 7.5 * scale * scale;
        trials.close(format!("a film's, of the mean, spread {scale:?}"), exact, found, tolerance * exact);
    }
    let mut random = Pcg64Mcg::new(12);
    let mut negative = 0;
    let tries = trials.times(20_000, 1_000_000);
    for _ in 0..tries {
        let value = 1.0 + random.next_u64() as f64;
        let found = film_sum(repeat_n(value, 4 + random.next_u64() as usize % 60)).variance();
        negative += u64::from(found < 0.0 || found > 1e-14 * value * value || found.is_nan());
    }
    trials.never("a film's, of equal samples", "variances below 0 or above rounding", negative, tries);
}

/// Films do not use compensated sums, but their error has a bound: for sums of m samples that are added along a tree
/// of depth d, (m - 1 + d) 2^-53 times the sum of the absolute values.
pub(super) fn cancellation(trials: &mut Trials) {
    let four = [1.0, 1e100, 1.0, -1e100];
    trials.same("unguarded, Kahan's sum", 0.0, kahan_sum(four.into_iter()));
    let within = |values: &[f64]| {
        let exact = double_double_sum(values.iter().copied());
        let sizes: f64 = values.iter().map(|value| value.abs()).sum();
        let depth = libm::ceil(libm::log2(values.len() as f64 / f64::from(SAMPLE_BLOCK))).max(0.0);
        let bound = (f64::from(SAMPLE_BLOCK) + depth) * f64::EPSILON / 2.0 * sizes;
        ((film_sum(values.iter().copied()).sum[0] - exact).abs(), bound)
    };
    let (error, bound) = within(&four);
    trials.holds("1, 1e100, 1, -1e100", format_args!("an error of at most {bound:.1e}"), error, error <= bound);
    let mut random = Pcg64Mcg::new(13);
    let tries = trials.times(200, 20_000);
    let (mut outside, mut worst) = (0, 0.0_f64);
    for size in 0..tries {
        // Magnitudes over sixteen decades; each value appears again later, negated and scaled by 0.999.
        let n = 1 + (size as usize * 37) % 3000;
        let mut values: Vec<f64> = Vec::with_capacity(2 * n);
        for _ in 0..n {
            let exponent = (random.next_u64() % 54) as i32 - 27;
            let value = libm::ldexp(1.0 + (random.next_u64() >> 12) as f64, exponent - 52);
            values.extend([value, 0.25 * value]);
        }
        let negative: Vec<f64> = values.iter().rev().map(|value| -value * 0.999).collect();
        values.extend(negative);
        let (error, bound) = within(&values);
        worst = worst.max(error / bound);
        outside += u64::from(error > bound);
    }
    trials.never(format!("sums that cancel; the worst is {worst:.3} of the bound"), "outside", outside, tries);
}
