//! Agreement of the estimators that split paths and those that do not. Closed forms are in the table of hard cases
//! (`crates/pathmark-check/src`).
//!
//! Levels are family-wise 1e-3 (Sidak) within each test, two-sided.

use pathmark::analysis::z_test::{critical_value, sidak};
use pathmark::kernel::Spec;
use pathmark::measure::{Outcome, Settings, Setup};
use pathmark::scene::{Scene, load};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::sync::Arc;

const LEVEL: f64 = 1e-3;

fn limit(tests: usize) -> f64 {
    critical_value(sidak(LEVEL, tests).unwrap()).unwrap()
}

fn run(scene: &Scene, spec: Spec, spp: u32) -> Outcome {
    let (decomposition, strategy) = ("rows".into(), "shared-counter".into());
    let settings = Settings { spp, spec, decomposition, strategy, threads: 2, ..Settings::default() };
    Setup::for_scene(Arc::new(scene.clone()), settings).unwrap().run(None).unwrap()
}

fn spec(estimator: &str, (width, height): (u32, u32), seed: u64) -> Spec {
    Spec { width, height, seed, estimator: estimator.into(), ..Spec::default() }
}

/// Means over blocks of 8 x 8 pixels and the channels. Each block has its mean over seeds and the squared standard
/// error of it.
fn blocks(estimator: &str, seeds: std::ops::Range<u64>) -> Vec<(f64, f64)> {
    const SIZE: (u32, u32) = (96, 72);
    let scene = load("cornell").unwrap();
    let n = seeds.clone().count() as f64;
    let mut sums = vec![(0.0, 0.0); 12 * 9];
    for seed in seeds {
        let image = run(&scene, spec(estimator, SIZE, seed), 32).film.image();
        let mut means = vec![0.0; sums.len()];
        for (k, pixel) in image.pixels.iter().enumerate() {
            means[k / 96 / 8 * 12 + k % 96 / 8] += pixel.iter().sum::<f64>() / 192.0;
        }
        for (sum, mean) in sums.iter_mut().zip(means) {
            *sum = (sum.0 + mean, sum.1 + mean * mean);
        }
    }
    sums.iter().map(|(sum, square)| (sum / n, (square / n - sum * sum / n / n).max(0.0) / (n - 1.0))).collect()
}

/// Splitting at glass and choosing at random give the same light: 108 block means over 16 seeds each, disjoint seeds.
/// The sum of squared scores is chi-square distributed, slightly widened by the 30 degrees of freedom of each error.
/// Too small a sum is wrong, too.
#[test]
fn the_estimators_agree() {
    let (a, b) = (blocks("smallpt", 100..116), blocks("bsdf", 200..216));
    let mut squares = 0.0;
    for (index, ((a, va), (b, vb))) in a.iter().zip(&b).enumerate() {
        let z = (a - b) / (va + vb).sqrt();
        // Student's t with 30 degrees of freedom exceeds 4.9 as often as a normal variate exceeds 4.
        assert!(z.abs() < limit(108) * 4.9 / 4.0, "block {index}: smallpt {a}, bsdf {b}, {z} errors");
        squares += z * z * 28.0 / 30.0;
    }
    let chi2 = ChiSquared::new(108.0).unwrap();
    let (low, high) = (chi2.inverse_cdf(LEVEL / 2.0), 1.1 * chi2.inverse_cdf(1.0 - LEVEL / 2.0));
    assert!((low..high).contains(&squares), "squared scores add up to {squares}, not within {low}..{high}");
}
