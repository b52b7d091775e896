//! `--max-depth`: what a cut keeps, and that it says so. P08 of the catalogue of hard cases.

use super::estimate::{
    arriving_estimators, assert_exact, camera, diffuse, full_estimators, mean, object, render, scene, sphere,
};
use pathmark::estimator::{Bsdf, Estimator, Options, Probe, camera_ray};
use pathmark::kernel::Spec;
use pathmark::math::Rgb;
use pathmark::measure::{Measured, Record, Settings, Setup, Warning};
use pathmark::sampling::{Independent, SampleKey};
use pathmark::scene::{AllEffects, Scene, load};
use std::sync::Arc;

fn hollow(albedo: f64) -> Scene {
    let wall = object(&sphere([0.0; 3], 1.0), &diffuse(albedo), [1.0; 3]);
    scene(&[camera([0.1, 0.2, 0.3], [1.0, 0.0, 0.0]), wall])
}

/// P08: D bounces keep sum rho^k Le for k up to D. Up to the fifth nothing is left to chance.
#[test]
fn a_cut_keeps_the_first_terms() {
    for (rho, depth, samples) in
        [(0.9, 0, 4096), (0.9, 1, 4096), (0.9, 5, 4096), (0.999, 5, 4096), (0.9, 49, 900_000), (0.5, 20, 40_000)]
    {
        let exact = (0..=depth).rev().fold(0.0, |sum, _| 1.0 + rho * sum);
        for estimator in arriving_estimators() {
            let outcome = render(&hollow(rho), estimator, samples, Some(depth));
            assert_exact(&format!("rho {rho}, depth {depth}, {estimator}"), &outcome, 0, exact, 12);
        }
    }
}

/// Neighbouring cuts differ by the light of the next bounce: rho^(D + 1) Le.
#[test]
fn neighbouring_cuts_differ_by_one_bounce() {
    for estimator in arriving_estimators() {
        let mut term = 1.0;
        for depth in 0..5 {
            let [less, more] = [depth, depth + 1].map(|d| mean(&render(&hollow(0.7), estimator, 1024, Some(d)), 0).0);
            term *= 0.7;
            assert!((more - less - term).abs() < 1e-13, "{estimator}, depth {depth}: {} is not {term}", more - less);
        }
    }
}

/// The light of a sample by the bounces that it has behind it.
#[derive(Default)]
struct ByBounce(Vec<Rgb>);

impl Probe for ByBounce {
    fn light(&mut self, bounces: u16, contribution: Rgb) {
        let index = usize::from(bounces);
        if self.0.len() <= index {
            self.0.resize(index + 1, Rgb::BLACK);
        }
        self.0[index] += contribution;
    }
}

/// In any scene a cut sample is the whole sample less what comes later, so the light of each bounce is known without a cut.
#[test]
fn a_cut_takes_later_bounces_and_nothing_else() {
    for name in ["cornell", "cornell-fog", "sky", "report-c"] {
        let scene = load(name).unwrap();
        let view = scene.camera.view(24, 18);
        let mut later = 0.0;
        for pixel in 0..24 * 18 {
            let key = SampleKey { seed: 5, pixel, sample: pixel % 4 };
            let ray = camera_ray::<_, AllEffects, ()>(&view, [pixel % 24, pixel / 24], key, &Independent, &mut ());
            let sample = |max_depth, probe: &mut ByBounce| {
                let options = Options { max_depth, ..Options::default() };
                Bsdf::new(options).sample::<_, AllEffects, _>(&scene, ray, key, &Independent, probe)
            };
            let mut whole = ByBounce::default();
            let total = sample(None, &mut whole).g;
            let mut kept = 0.0;
            for (depth, light) in (0..12).zip(whole.0.iter().map(|light| light.g).chain(std::iter::repeat(0.0))) {
                kept += light;
                let found = sample(Some(depth), &mut ByBounce::default()).g;
                assert!((found - kept).abs() <= 1e-12 * total, "{name}, depth {depth}: {found} instead of {kept}");
            }
            later += total - kept;
        }
        assert!(later >= 0.0, "{name}");
    }
}

/// A record names the cut and calls the image biased; nothing is said of one that was not cut.
#[test]
fn a_cut_is_on_record() {
    let record = |estimator: &str, max_depth| {
        let spec = Spec { width: 8, height: 6, estimator: estimator.into(), max_depth, ..Spec::default() };
        let settings = Settings { spp: 4, spec, threads: 1, ..Settings::default() };
        let setup = Setup::for_scene(Arc::new(load("cornell").unwrap()), settings).unwrap();
        let outcome = setup.run(None).unwrap();
        let warned = outcome.warnings.contains(&Warning::Biased);
        let cut = outcome.warnings.iter().any(|warning| matches!(warning, Warning::Truncated(_)));
        assert!(!cut, "a cut that was asked for is no leak");
        let record = Record::new(&setup, &outcome, Measured::default());
        (record.max_depth, record.biased, warned, outcome.counts.truncated > 0)
    };
    for estimator in full_estimators() {
        assert_eq!(record(estimator, Some(2)), (Some(2), true, true, true), "{estimator}");
        assert_eq!(record(estimator, None), (None, false, false, false), "{estimator}");
    }
    // Whitted's leaves out light whatever its depth, and has one of its own.
    assert_eq!(record("whitted", None), (Some(10), true, true, true));
    assert_eq!(record("whitted", Some(0)), (Some(0), true, true, true));
}

/// P01: a closed mirror that loses nothing never ends a path: it is cut, counted and warned of.
#[test]
fn an_endless_path_is_warned_of() {
    let mirror = "{ mirror = { albedo = [1.0, 1.0, 1.0] } }";
    let scene = scene(&[camera([0.1, 0.2, 0.3], [1.0, 0.0, 0.0]), object(&sphere([0.0; 3], 1.0), mirror, [0.0; 3])]);
    let spec = Spec { width: 2, height: 1, estimator: "bsdf".into(), ..Spec::default() };
    let settings = Settings { spp: 2, spec, threads: 1, ..Settings::default() };
    let outcome = Setup::for_scene(Arc::new(scene), settings).unwrap().run(None).unwrap();
    assert_eq!((outcome.counts.paths, outcome.counts.truncated, outcome.counts.escaped), (4, 4, 0));
    assert!(outcome.warnings.contains(&Warning::Truncated(4)));
}
