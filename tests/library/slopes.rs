//! Convergence of independent samples: the error of an unbiased estimator falls with the root of the samples: the
//! slope -1/2, in a narrow interval.
//!
//! Each curve is one long render, read out at several numbers of samples. Where the exact image is known, the error is
//! the distance from it. Elsewhere it is the spread over seeds, which is equivalent for an unbiased estimator
//! (`tests/estimators` and the analytic scenes test the bias).

use pathmark::analysis::Estimate;
use pathmark::analysis::jackknife::{Curve, SeedCurves};
use pathmark::analysis::slope::{PowerLaw, power_law};
use pathmark::analysis::z_test::sidak;
use pathmark::check::stage::{camera, diffuse, object, plane, scene, sphere};
use pathmark::kernel::Spec;
use pathmark::measure::{Rounds, Settings, Setup};
use pathmark::scene::{SCENES, Scene, load};
use std::sync::Arc;

/// Largest half-width of a 95 % interval.
const HALF_WIDTH: f64 = 0.01;

struct Curves {
    scene: Arc<Scene>,
    estimator: &'static str,
    size: (u32, u32),
    spps: Vec<u32>,
}

impl Curves {
    /// The values of a seed's images at all numbers of samples.
    fn images(&self, seed: u64) -> Vec<Vec<f64>> {
        let (width, height) = self.size;
        let spec = Spec { width, height, seed, estimator: self.estimator.into(), ..Spec::default() };
        let (decomposition, strategy) = ("rows".into(), "shared-counter".into());
        let settings = Settings {
            spp: *self.spps.last().unwrap(),
            spec,
            decomposition,
            strategy,
            threads: 2,
            ..Settings::default()
        };
        let mut rounds = Rounds::new(Setup::for_scene(Arc::clone(&self.scene), settings).unwrap()).unwrap();
        let mut image = |spp: &u32| {
            rounds.extend_to(*spp, None).unwrap();
            rounds.film().image().pixels.into_flattened()
        };
        self.spps.iter().map(&mut image).collect()
    }

    fn at(&self) -> Vec<f64> {
        self.spps.iter().map(|spp| f64::from(*spp)).collect()
    }

    /// The slope computed from the spread over seeds.
    fn by_spread(&self, seeds: u64, level: f64) -> Option<PowerLaw> {
        let images: Vec<Vec<Vec<f64>>> = (0..seeds).map(|seed| self.images(500 + seed)).collect();
        let at = |point: usize| images.iter().map(|of| of[point].as_slice()).collect();
        let seen: Vec<Vec<&[f64]>> = (0..self.spps.len()).map(at).collect();
        power_law(&SeedCurves::of_images(&self.at(), &seen)?, level)
    }

    /// The slope computed from the distance to the exact value, which is the same for all pixels.
    fn by_truth(&self, exact: f64, seeds: u64, level: f64) -> Option<PowerLaw> {
        let mse = |image: &Vec<f64>| {
            image.iter().map(|value| (value - exact) * (value - exact)).sum::<f64>() / image.len() as f64
        };
        let curve =
            |seed: u64| -> Curve { self.at().into_iter().zip(self.images(500 + seed).iter().map(mse)).collect() };
        power_law(&SeedCurves::of_errors(&(0..seeds).map(curve).collect::<Vec<_>>())?, level)
    }
}

fn check(what: &str, law: Option<PowerLaw>) {
    let Estimate { value, interval } = law.unwrap().exponent;
    let half_width = 0.5 * (interval.high - interval.low);
    println!("{what}: {value:.4} +- {half_width:.4}");
    assert!(interval.contains(-0.5), "{what}: {value}, {interval:?}");
    assert!(half_width <= HALF_WIDTH, "{what}: {interval:?}");
}

#[test]
fn analytic_scenes() {
    let hollow = |albedo: f64, emission: f64| object(&sphere([0.0; 3], 1.0), &diffuse(albedo), [emission; 3]);
    let lamp = |center: [f64; 3], radius: f64| object(&sphere(center, radius), &diffuse(0.0), [1.0; 3]);
    let floor = object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(0.5), [0.0; 3]);
    let earth = object(&plane([0.0, -5.0, 0.0], [0.0, 1.0, 0.0]), &diffuse(0.0), [0.0; 3]);
    let sky = "background = [1.0, 1.0, 1.0]\n".to_string();
    let scenes = [
        ("A1", 2.0, vec![camera([0.1, 0.2, 0.3], [1.0, 0.0, 0.0]), hollow(0.5, 1.0)]),
        ("A4", 0.2, vec![camera([0.0, 0.75, 0.0], [0.6, 0.8, 0.0]), hollow(0.5, 0.0), lamp([0.0; 3], 0.5)]),
        ("A6", 0.125, vec![camera([3.0, 0.02, 0.0], [0.0; 3]), floor, lamp([0.0, 2.0, 0.0], 1.0)]),
        ("A12", 0.25, vec![sky, camera([4.0, 0.0, 0.0], [0.0; 3]), earth, hollow(0.5, 0.0)]),
    ];
    for (name, exact, parts) in scenes {
        let spps = (2..=9).map(|power| 1 << power).collect();
        let curves = Curves { scene: Arc::new(scene(&parts)), estimator: "bsdf", size: (32, 32), spps };
        check(name, curves.by_truth(exact, 10, 0.95));
    }
}

/// smallpt's method of finding light. With `mis` the interval is twice as wide, because the small remaining error
/// comes from rare paths.
#[test]
fn smallpts_box() {
    let spps = (2..=8).map(|power| 1 << power).collect();
    let curves = Curves { scene: Arc::new(load("cornell").unwrap()), estimator: "bsdf", size: (48, 36), spps };
    check("cornell", curves.by_spread(16, 0.95));
}

/// Short renders of all scenes: -1/2 lies in their intervals at the family-wise level 1e-3. Where few paths carry much
/// light, as on `nightsky`, the interval of so short a render is too wide to say much.
#[test]
fn every_scene() {
    let level = 1.0 - sidak(1e-3, SCENES.len()).unwrap();
    let mut wrong = Vec::new();
    for (name, _) in SCENES {
        let name = if *name == "spheres" { "spheres:100" } else { name };
        let spps = vec![4, 8, 16, 32];
        let curves = Curves { scene: Arc::new(load(name).unwrap()), estimator: "mis", size: (12, 9), spps };
        // A scene in which nothing is random has no slope.
        let Some(law) = curves.by_spread(12, level) else {
            println!("{name}: no slope");
            continue;
        };
        println!("{name}: {:.3} {:?}", law.exponent.value, law.exponent.interval);
        if !law.exponent.interval.contains(-0.5) {
            wrong.push(format!("{name}: {:?}", law.exponent));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
