//! Agreement of all estimators that follow all light, however they find it: emissive mirrors, light behind glass, a
//! camera inside a light, enclosures that glow.
//!
//! The standardised differences to `bsdf`, pixel by pixel, must have mean 0 and variance 1. Both are tested on both
//! sides, at the family-wise level 1e-3. Each pixel contributes one channel, in turn, because the channels of a pixel
//! are correlated.

use pathmark::analysis::z_test::{critical_value, sidak};
use pathmark::estimator::ESTIMATORS;
use pathmark::film::{Film, PixelSum};
use pathmark::kernel::Spec;
use pathmark::measure::{Settings, Setup};
use pathmark::scene::{SCENES, Scene, load};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::sync::Arc;

/// Few pixels with many samples: a z-score is normal only if the sample variance has converged. `PATHMARK_THOROUGH`
/// doubles them.
fn size() -> (u32, u32) {
    if std::env::var_os("PATHMARK_THOROUGH").is_some() { (8, 6) } else { (6, 4) }
}

const SPP: u32 = 1024;
const LEVEL: f64 = 1e-3;

/// Scenes in which few paths hit the small, bright lamps unless they aim at them. The variance of such paths within a
/// pixel is unreliable, so `nee` and `mis` are compared by pixels, and both with `bsdf` by the mean of the image.
const RARELY_MET: [&str; 3] = ["cornell-small-light", "nightsky", "toy-path-tracer"];

fn film(scene: &Arc<Scene>, (estimator, camera_rays): (&str, Option<u16>), seed: u64) -> Film {
    let (width, height) = size();
    let spec = Spec { width, height, seed, estimator: estimator.into(), camera_rays, ..Spec::default() };
    let settings = Settings {
        spp: SPP,
        spec,
        decomposition: "tiles:8x8".into(),
        strategy: "work-stealing".into(),
        ..Settings::default()
    };
    let outcome = Setup::for_scene(Arc::clone(scene), settings).unwrap().run(None).unwrap();
    assert_eq!(outcome.counts.invalid, 0, "{}, {estimator}", scene.name);
    outcome.film
}

/// The mean and its variance, for one channel of each pixel.
fn pixels(film: &Film) -> Vec<(f64, f64)> {
    let estimate = |(index, pixel): (usize, &PixelSum)| {
        let (channel, n) = (index % 3, f64::from(pixel.count));
        let (sum, square) = (pixel.sum[channel], pixel.square[channel]);
        (sum / n, (square - sum * sum / n).max(0.0) / (n * (n - 1.0)))
    };
    film.pixels().iter().enumerate().map(estimate).collect()
}

/// The standardised differences of two images, pixel by pixel, where either has any variance.
fn scores(a: &[(f64, f64)], b: &[(f64, f64)]) -> Vec<f64> {
    let pairs = a.iter().zip(b).filter(|(a, b)| a.1 + b.1 > 0.0);
    pairs.map(|(a, b)| (a.0 - b.0) / (a.1 + b.1).sqrt()).collect()
}

/// The standardised difference of the means of two images.
fn score_of_means(a: &[(f64, f64)], b: &[(f64, f64)]) -> f64 {
    let (sum, variance) = a.iter().zip(b).fold((0.0, 0.0), |(s, v), (a, b)| (s + a.0 - b.0, v + a.1 + b.1));
    sum / f64::sqrt(variance)
}

/// The disagreement of two images, if any: in the mean of the scores, or in the sum of their squares.
fn disagreement(scores: &[f64], level: f64) -> Option<String> {
    let n = scores.len() as f64;
    let mean = scores.iter().sum::<f64>() / n.sqrt();
    let square: f64 = scores.iter().map(|z| z * z).sum();
    let below = ChiSquared::new(n).unwrap().cdf(square);
    let spread = 2.0 * below.min(1.0 - below);
    let wrong = mean.abs() > critical_value(level).unwrap() || spread < level;
    wrong.then(|| format!("mean {mean:.2}, squares {square:.1} of {n}"))
}

#[test]
fn estimators_agree_on_every_scene() {
    let names = ESTIMATORS.iter().map(|entry| entry.name).filter(|name| !["bsdf", "whitted"].contains(name));
    // Several camera rays do not change the expectation, either.
    let others: Vec<(&str, Option<u16>)> =
        names.map(|name| (name, None)).chain([("bsdf", Some(4)), ("mis", Some(4))]).collect();
    let level = sidak(LEVEL, 2 * SCENES.len() * others.len()).unwrap();
    let mut wrong = Vec::new();
    for (scene, _) in SCENES {
        let scene = if *scene == "spheres" { "spheres:100" } else { scene };
        let loaded = Arc::new(load(scene).unwrap());
        let right = pixels(&film(&loaded, ("bsdf", None), 1));
        let images: Vec<_> =
            (2..).zip(&others).map(|(seed, other)| (*other, pixels(&film(&loaded, *other, seed)))).collect();
        let one_ray =
            |name: &str| images.iter().find(|(other, _)| *other == (name, None)).map_or(&right, |found| &found.1);
        let mut compare = |what: &str, scores: &[f64]| {
            wrong.extend(disagreement(scores, level).map(|words| format!("{scene}, {what}: {words}")));
        };
        for ((name, rays), image) in &images {
            let is_rare = RARELY_MET.contains(&scene);
            if is_rare {
                let z = score_of_means(image, &right);
                compare(&format!("mean of {name}, camera rays {rays:?}, against bsdf"), &[z]);
            }
            // Several camera rays are compared with one. In scenes with rarely met lamps, `bsdf` is compared by means
            // only.
            let right = if rays.is_some() { one_ray(name) } else { &right };
            if !is_rare || rays.is_some() && *name != "bsdf" {
                let scores = scores(image, right);
                if scores.is_empty() {
                    let sum = |image: &[(f64, f64)]| image.iter().map(|pixel| pixel.0).sum::<f64>();
                    assert_eq!(sum(image), sum(right), "{scene}, {name}, camera rays {rays:?}");
                } else {
                    compare(&format!("{name}, camera rays {rays:?}"), &scores);
                }
            }
        }
        if RARELY_MET.contains(&scene) {
            compare("mis against nee", &scores(one_ray("mis"), one_ray("nee")));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
