//! Light arrives with the right mean and the right spread: closed forms for closed scenes, P01-P10 and H14 of the catalogue of hard
//! cases, smallpt's own image, and the agreement of the estimators.
//!
//! Levels are family-wise 1e-3 (Sidak) within each test, two-sided. A test whose error bar is wider than what it should see is itself a
//! failure.

#[path = "support/scene_text.rs"]
mod scene_text;

use pathmark::analysis::z_test::{critical_value, sidak};
use pathmark::estimator::MAX_BOUNCES;
use pathmark::film::Film;
use pathmark::kernel::{Clamp, Spec};
use pathmark::math::Rgb;
use pathmark::measure::{Outcome, Settings, Setup, Warning};
use pathmark::scene::{Scene, load};
use scene_text::{Ball, load_scene};
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

/// A closed sphere around the camera.
fn furnace(material: &str, emission: [f64; 3]) -> Scene {
    let ball = Ball { center: [0.0; 3], radius: 2.0, material: material.into(), emission };
    load_scene([0.3, -0.2, 0.5], &[ball]).unwrap()
}

fn diffuse(albedo: [f64; 3]) -> String {
    format!("{{ diffuse = {{ albedo = {albedo:?} }} }}")
}

/// Of one channel of all samples: mean, variance within the pixels, and number.
struct Moments {
    mean: f64,
    variance: f64,
    n: f64,
}

impl Moments {
    fn of(film: &Film, channel: usize) -> Self {
        let (mut n, mut sum, mut spread) = (0.0, 0.0, 0.0);
        for pixel in film.pixels() {
            n += f64::from(pixel.count);
            sum += pixel.sum[channel];
            spread += pixel.square[channel] - pixel.sum[channel] * pixel.sum[channel] / f64::from(pixel.count);
        }
        Self { mean: sum / n, variance: spread / (n - film.pixels().len() as f64), n }
    }

    fn error(&self) -> f64 {
        (self.variance / self.n).sqrt()
    }
}

/// A1, P06, P07: radiance Le/(1 - rho) in a closed sphere, and the spread of its estimate. Five vertices are certain; from the sixth on
/// roulette with survival rho leaves rho^5 G with G geometric, so the variance is rho^10 rho/(1 - rho)^2 and that of its estimate
/// follows from the kurtosis 9 + (1 - rho)^2/rho.
#[test]
fn roulette_keeps_mean_and_variance() {
    let cases = [0.1, 0.5, 0.75, 0.9];
    for rho in cases {
        for estimator in ["smallpt", "bsdf"] {
            let outcome = run(&furnace(&diffuse([rho; 3]), [1.0; 3]), spec(estimator, (64, 48), 22), 64);
            let found = Moments::of(&outcome.film, 0);
            let q = 1.0 - rho;
            let rho5 = rho * rho * rho * rho * rho;
            let variance = rho5 * rho5 * rho / (q * q);
            let z_mean = (found.mean - 1.0 / q) / (variance / found.n).sqrt();
            let z_variance = (found.variance / variance - 1.0) / ((8.0 + q * q / rho) / found.n).sqrt();
            let most = limit(cases.len() * 4);
            assert!(z_mean.abs() < most, "rho {rho}, {estimator}: mean {} ({z_mean} errors)", found.mean);
            assert!(
                z_variance.abs() < most,
                "rho {rho}, {estimator}: variance {} ({z_variance} errors)",
                found.variance
            );
            assert_eq!(outcome.counts.escaped, 0);
        }
    }
}

/// P06: channels of different albedo under one roulette, driven by the largest: each keeps its own mean.
#[test]
fn roulette_by_the_largest_channel_is_fair_to_the_others() {
    let albedo = [0.5, 0.9, 0.2];
    let outcome = run(&furnace(&diffuse(albedo), [1.0, 2.0, 3.0]), spec("bsdf", (64, 48), 23), 64);
    for (channel, expected) in [2.0, 20.0, 3.75].into_iter().enumerate() {
        let found = Moments::of(&outcome.film, channel);
        let z = (found.mean - expected) / found.error();
        assert!(z.abs() < limit(3), "channel {channel}: {} instead of {expected} ({z} errors)", found.mean);
    }
}

/// P01, P02, P03: a mirror that loses nothing in one channel never ends a path, so 65 536 vertices are visited in a loop, the cut is
/// counted, and the other channels are the geometric series with rho = 0.999 (term 10 000 is 4.5e-5, relative 1e-11) and 0.9, whose last
/// terms are below the smallest number there is.
#[test]
fn endless_mirrors_are_cut_and_counted() {
    let scene = furnace("{ mirror = { albedo = [1.0, 0.999, 0.9] } }", [0.0, 1.0, 1.0]);
    for estimator in ["smallpt", "bsdf"] {
        let Outcome { film, counts, warnings, .. } = run(&scene, spec(estimator, (3, 2), 24), 4);
        assert_eq!((counts.paths, counts.truncated, counts.escaped, counts.invalid), (24, 24, 0, 0));
        assert_eq!(counts.rays, 24 * (u64::from(MAX_BOUNCES) + 1));
        assert!(warnings.contains(&Warning::Truncated(24)));
        for pixel in film.pixels() {
            let [r, g, b] = pixel.mean();
            assert!(r == 0.0 && (g / 1000.0 - 1.0).abs() < 1e-11 && (b / 10.0 - 1.0).abs() < 1e-13, "{r} {g} {b}");
        }
    }
}

/// P04, P05: on black the path ends at once, whatever the random number, and has collected what is there.
#[test]
fn black_surfaces_end_the_path() {
    let Outcome { film, counts, .. } =
        run(&furnace(&diffuse([0.0; 3]), [3.0, 0.0, 0.5]), spec("bsdf", (16, 12), 25), 16);
    assert_eq!((counts.rays, counts.paths), (16 * 12 * 16, 16 * 12 * 16));
    assert!(film.pixels().iter().all(|pixel| pixel.mean() == [3.0, 0.0, 0.5]));
}

/// P09: every sample in this sphere is at least Le = 1 with mean 10, so smallpt's clamp leaves exactly 1; off by default, and marked.
#[test]
fn the_subpixel_clamp_is_biased_and_says_so() {
    let scene = furnace(&diffuse([0.9; 3]), [1.0; 3]);
    let plain = run(&scene, spec("smallpt", (16, 12), 26), 16);
    assert!(Moments::of(&plain.film, 0).mean > 9.0 && !plain.warnings.contains(&Warning::Biased));
    let clamped = run(&scene, Spec { clamp: Some(Clamp::Subpixel), ..spec("smallpt", (16, 12), 26) }, 16);
    assert!(clamped.film.pixels().iter().all(|pixel| pixel.mean() == [1.0; 3]));
    assert!(clamped.warnings.contains(&Warning::Biased));
}

/// P10: samples that are NaN, infinite or negative are counted, contribute nothing, and are reported. The reader refuses such emission, so
/// it is put in behind its back.
#[test]
fn invalid_samples_are_counted_and_left_out() {
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        let mut scene = furnace(&diffuse([0.5; 3]), [1.0; 3]);
        scene.objects[0].emission = Rgb { r: 1.0, g: bad, b: 1.0 };
        let all = run(&scene, spec("bsdf", (8, 6), 27), 4);
        assert_eq!((all.counts.invalid, all.counts.paths), (192, 192), "{bad}");
        assert!(all.film.pixels().iter().all(|pixel| pixel.sum == [0.0; 3] && pixel.count == 4), "{bad}");
        assert!(all.warnings.contains(&Warning::InvalidSamples(192)));

        let mut scene = load("cornell").unwrap();
        scene.objects.last_mut().unwrap().emission = Rgb { r: bad, g: bad, b: bad };
        let some = run(&scene, spec("bsdf", (32, 24), 27), 16);
        // Every other path misses the light and is black.
        assert!((1..some.counts.paths).contains(&some.counts.invalid), "{bad}: {}", some.counts.invalid);
        assert!(some.film.pixels().iter().all(|pixel| pixel.sum == [0.0; 3]), "{bad}");
    }
}

/// Means over blocks of 8 x 8 pixels and the channels, seed by seed: block -> (mean over seeds, its squared standard error).
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

/// Splitting glass or choosing at random is the same light: 108 block means over 16 seeds each, disjoint seeds. The sum of squares of the
/// scores is chi-square distributed, widened a little by the 30 degrees of freedom of each error; too small is wrong too.
#[test]
fn the_estimators_agree() {
    let (a, b) = (blocks("smallpt", 100..116), blocks("bsdf", 200..216));
    let mut squares = 0.0;
    for (index, ((a, va), (b, vb))) in a.iter().zip(&b).enumerate() {
        let z = (a - b) / (va + vb).sqrt();
        // Student's t with 30 degrees of freedom passes 4.9 as often as a normal value passes 4.
        assert!(z.abs() < limit(108) * 4.9 / 4.0, "block {index}: smallpt {a}, bsdf {b}, {z} errors");
        squares += z * z * 28.0 / 30.0;
    }
    let chi2 = ChiSquared::new(108.0).unwrap();
    let (low, high) = (chi2.inverse_cdf(LEVEL / 2.0), 1.1 * chi2.inverse_cdf(1.0 - LEVEL / 2.0));
    assert!((low..high).contains(&squares), "squared scores add up to {squares}, not within {low}..{high}");
}
