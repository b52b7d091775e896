//! Every estimator that follows all light gives the same image, whichever way it finds light: emissive mirrors, light behind glass, a
//! camera inside a light, enclosures that glow.
//!
//! An image is cut into blocks. Over all of them the standardised differences to `bsdf` must have the mean 0 and the variance 1, which is tested on
//! both sides, at the family-wise level 1e-3.

use pathmark::analysis::z_test::{critical_value, sidak};
use pathmark::estimator::ESTIMATORS;
use pathmark::film::Film;
use pathmark::kernel::Spec;
use pathmark::measure::{Settings, Setup};
use pathmark::scene::SCENES;
use statrs::distribution::{ChiSquared, ContinuousCDF};

const SIZE: (u32, u32) = (32, 24);
const BLOCK: u32 = 8;
const SPP: u32 = 64;
const LEVEL: f64 = 1e-3;

/// A scene in which few samples meet the small, bright lamps unless they are aimed at, so that the spread of `bsdf` within a block tells too
/// little: the blocks' variance is not tested there.
const HEAVY: [&str; 1] = ["nightsky"];

fn film(scene: &str, estimator: &str, seed: u64) -> Film {
    let spec = Spec { width: SIZE.0, height: SIZE.1, seed, estimator: estimator.into(), ..Spec::default() };
    let settings = Settings {
        scene: scene.into(),
        spp: SPP,
        spec,
        decomposition: "tiles:8x8".into(),
        strategy: "work-stealing".into(),
        ..Settings::default()
    };
    let outcome = Setup::prepare(settings).unwrap().run(None).unwrap();
    assert_eq!(outcome.counts.invalid, 0, "{scene}, {estimator}");
    outcome.film
}

/// Mean radiance of each block and the variance of that mean, by the spread within the pixels.
fn blocks(film: &Film) -> Vec<(f64, f64)> {
    let mut blocks = vec![(0.0, 0.0); (SIZE.0 / BLOCK * (SIZE.1 / BLOCK)) as usize];
    let pixels = f64::from(3 * BLOCK * BLOCK);
    for (index, pixel) in (0..).zip(film.pixels()) {
        let (x, y) = (index % SIZE.0, index / SIZE.0);
        let block = &mut blocks[(y / BLOCK * (SIZE.0 / BLOCK) + x / BLOCK) as usize];
        let n = f64::from(pixel.count);
        // Channels go together, so the deviation of their mean is at most the mean of theirs.
        let deviations = (0..3).map(|c| ((pixel.square[c] - pixel.sum[c] * pixel.sum[c] / n).max(0.0)).sqrt());
        let deviation = deviations.sum::<f64>();
        block.0 += pixel.mean().iter().sum::<f64>() / pixels;
        block.1 += deviation * deviation / (n * (n - 1.0)) / (pixels * pixels);
    }
    blocks
}

#[test]
fn estimators_agree_on_every_scene() {
    let others: Vec<&str> =
        ESTIMATORS.iter().map(|entry| entry.name).filter(|name| !["bsdf", "whitted"].contains(name)).collect();
    let level = sidak(LEVEL, 2 * SCENES.len() * others.len()).unwrap();
    let mut wrong = Vec::new();
    for (scene, _) in SCENES {
        let scene = if *scene == "spheres" { "spheres:100" } else { scene };
        let right = blocks(&film(scene, "bsdf", 1));
        for (seed, estimator) in (2..).zip(&others) {
            let found = blocks(&film(scene, estimator, seed));
            let z: Vec<f64> = found
                .iter()
                .zip(&right)
                .filter(|(a, b)| a.1 + b.1 > 0.0)
                .map(|(a, b)| (a.0 - b.0) / (a.1 + b.1).sqrt())
                .collect();
            let n = z.len() as f64;
            if z.is_empty() {
                assert_eq!(found.iter().map(|b| b.0).sum::<f64>(), right.iter().map(|b| b.0).sum::<f64>(), "{scene}");
                continue;
            }
            let mean = z.iter().sum::<f64>() / n.sqrt();
            let square: f64 = z.iter().map(|z| z * z).sum();
            let below = ChiSquared::new(n).unwrap().cdf(square);
            let spread = 2.0 * below.min(1.0 - below);
            println!("{scene}, {estimator}: mean {mean:.2}, {square:.1} of {n}, p {spread:.2e}");
            if mean.abs() > critical_value(level).unwrap() || (spread < level && !HEAVY.contains(&scene)) {
                wrong.push(format!("{scene}, {estimator}: mean {mean}, squares {square} of {n}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
