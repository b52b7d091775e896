//! Convergence of single precision to the image of double precision, pixel by pixel and without lost rays.
//!
//! Each pixel of each scene is rendered in both precisions with eight seeds each, all different. The difference of the
//! means over its standard error follows Student's t with 14 degrees of freedom. Its square has the mean 14/12 and a
//! known variance, and the mean of squares over many pixels is normal. Too small a value is wrong, too: then the two
//! images would not be independent.

use super::{is_for_lanes, render};
use crate::watchdog::Watchdog;
use pathmark::film::{Bounds, Piece};
use pathmark::kernel::{Counts, Spec, build};
use pathmark::scene::{SCENES, Scene, load};
use statrs::distribution::{ContinuousCDF, Normal};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// Seeds per precision.
const SEEDS: u64 = 8;
const WIDTH: u32 = 32;
const HEIGHT: u32 = 24;
/// Samples of both precisions and all scenes together in a thorough test.
const THOROUGH: f64 = 1e9;
/// Relative change of a radiance by a few operations in single precision.
const ROUNDING: f64 = 1e-6;
/// Relative change that single precision may cause in the mean of `cornell`.
const DARKER: f64 = 2e-4;

fn is_thorough() -> bool {
    std::env::var_os("PATHMARK_THOROUGH").is_some()
}

/// The mean of each pixel's channels, in this precision and with this seed.
fn image(scene: &Arc<Scene>, precision: &str, seed: u64, spp: u32) -> (Vec<f64>, Counts) {
    let spec = Spec {
        width: WIDTH,
        height: HEIGHT,
        estimator: "mis".into(),
        precision: precision.into(),
        seed,
        ..Spec::default()
    };
    let bounds = Bounds { x0: 0, y0: 0, x1: WIDTH, y1: HEIGHT };
    let (buffer, counts) = render(&*build(scene, &spec).unwrap(), &Piece { bounds, samples: 0..spp });
    (buffer.rows().flatten().map(|pixel| pixel.mean().iter().sum::<f64>() / 3.0).collect(), counts)
}

/// The images of the seeds from `first` on.
fn images(scene: &Arc<Scene>, precision: &str, first: u64, spp: u32) -> Vec<(Vec<f64>, Counts)> {
    thread::scope(|scope| {
        let half = |from: u64| {
            scope.spawn(move || -> Vec<_> {
                (from..from + SEEDS / 2).map(|seed| image(scene, precision, seed, spp)).collect()
            })
        };
        let halves = [half(first), half(first + SEEDS / 2)];
        halves.into_iter().flat_map(|half| half.join().unwrap()).collect()
    })
}

/// The mean of the values, and the variance of this mean.
fn mean_of(values: impl ExactSizeIterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let squares: f64 = values.map(|value| (value - mean) * (value - mean)).sum();
    (mean, squares / (n - 1.0) / n)
}

/// Deviation of the mean square of the pixels' t from its expectation, in standard deviations.
fn score(single: &[(Vec<f64>, Counts)], double: &[(Vec<f64>, Counts)]) -> f64 {
    let degrees = (2 * SEEDS - 2) as f64;
    let expected = degrees / (degrees - 2.0);
    let variance = expected * expected * 2.0 * (degrees - 1.0) / (degrees - 4.0);
    let (mut sum, mut pixels) = (0.0, 0.0);
    for pixel in 0..(WIDTH * HEIGHT) as usize {
        let of = |images: &[(Vec<f64>, Counts)]| {
            mean_of(images.iter().map(|(image, _)| image[pixel]).collect::<Vec<_>>().into_iter())
        };
        let ((m1, v1), (m2, v2)) = (of(single), of(double));
        if (v1 + v2).sqrt() <= ROUNDING * m2.abs() {
            // All samples of this pixel are equal except for rounding: a light, seen directly or in mirrors.
            assert!((m1 - m2).abs() <= 8.0 * ROUNDING * m2.abs(), "pixel {pixel}: {m1}, {m2}");
            continue;
        }
        sum += (m1 - m2) * (m1 - m2) / (v1 + v2);
        pixels += 1.0;
    }
    (sum / pixels - expected) / (variance / pixels).sqrt()
}

/// Family-wise 1e-3, two-sided. Few samples have heavy tails, which make t smaller than Student's: then only too large
/// a score is wrong.
#[test]
fn pixels_of_single_precision_converge_to_those_of_double() {
    let watchdog = Watchdog::new(Duration::from_mins(if is_thorough() { 60 } else { 5 }));
    let scenes: Vec<Arc<Scene>> = SCENES.iter().map(|(name, _)| Arc::new(load(name).unwrap())).collect();
    let is_tried = |scene: &&Arc<Scene>| {
        scene.primitives.spheres.len() == scene.owners.len()
            && scene.hierarchy.is_none()
            && is_for_lanes(scene, &Spec { estimator: "mis".into(), ..Spec::default() })
    };
    let scenes: Vec<&Arc<Scene>> = scenes.iter().filter(is_tried).collect();
    assert!(scenes.len() > 10, "{} scenes of spheres", scenes.len());
    let images_of_all = scenes.len() as f64 * 2.0 * SEEDS as f64;
    let spp = if is_thorough() { (THOROUGH / images_of_all / f64::from(WIDTH * HEIGHT)).ceil() as u32 } else { 16 };
    let critical = Normal::standard().inverse_cdf(1.0 - 1e-3 / scenes.len() as f64 / 2.0);
    for scene in &scenes {
        watchdog.now(scene.name.clone());
        let (single, double) = (images(scene, "f32", 1, spp), images(scene, "f64", 1 + SEEDS, spp));
        for (_, counts) in &single {
            assert_eq!((counts.invalid, counts.paths), (0, u64::from(spp * WIDTH * HEIGHT)), "{}", scene.name);
        }
        let escaped = |images: &[(Vec<f64>, Counts)]| images.iter().map(|(_, counts)| counts.escaped).sum::<u64>();
        assert!(escaped(&single) == 0 || escaped(&double) > 0, "{}: {} rays escaped", scene.name, escaped(&single));
        let z = score(&single, &double);
        println!("{}: z = {z:.2} after {spp} spp and {SEEDS} seeds of each precision", scene.name);
        assert!(z < critical && (z > -critical || !is_thorough()), "{}: z = {z}", scene.name);
    }
}

/// With the same seeds most paths are nearly the same, so the mean over the image shows the effect of rounding.
#[test]
fn single_precision_makes_cornell_neither_lighter_nor_darker() {
    let watchdog = Watchdog::new(Duration::from_mins(30));
    watchdog.now("cornell");
    let scene = Arc::new(load("cornell").unwrap());
    let spp = if is_thorough() { 8192 } else { 256 };
    let [single, double] = ["f32", "f64"].map(|precision| images(&scene, precision, 1, spp));
    let mean = |(image, _): &(Vec<f64>, Counts)| image.iter().sum::<f64>() / image.len() as f64;
    let ratios: Vec<f64> = single.iter().zip(&double).map(|(one, two)| mean(one) / mean(two) - 1.0).collect();
    let (ratio, variance) = mean_of(ratios.into_iter());
    // Student's t of 7 degrees of freedom, at 1e-3.
    let error = 5.41 * variance.sqrt();
    println!("cornell: {ratio:.2e} +- {error:.1e} lighter");
    let limit = if is_thorough() { DARKER } else { DARKER + error };
    assert!(ratio.abs() + if is_thorough() { error } else { 0.0 } < limit, "{ratio} +- {error}");
}
