//! Whitted's estimator: where it agrees with the full estimators, and that it draws no random number.

use crate::estimate::{camera, diffuse, full_estimators, mean, object, plane, point_light, render, scene, sphere};
use pathmark::analysis::z_test::{critical_value, sidak};
use pathmark::estimator::{Estimator, Options, Whitted};
use pathmark::sampling::{Address, SampleKey, Sampler};
use pathmark::scene::{AllEffects, load};

/// The estimators agree where there is no indirect diffuse light: glass, a mirror and a polished black ball in a
/// glowing sphere, and a point light on a wall that no other surface lights.
#[test]
fn agrees_where_there_is_no_indirect_diffuse_light() {
    let glass = "{ dielectric = { eta = 1.5, tint = [0.9, 1.0, 0.8] } }";
    let wall = object(&plane([0.0, 0.0, -3.0], [0.0, 0.0, 1.0]), &diffuse(0.6), [0.2, 0.4, 0.3]);
    let light = point_light([0.5, 0.5, -2.0], 4.0);
    let polished = "{ polished = { albedo = [0.0, 0.0, 0.0], reflectivity = 0.8 } }";
    for (what, ball) in
        [("glass", glass), ("mirror", "{ mirror = { albedo = [0.9, 0.8, 0.7] } }"), ("polished", polished)]
    {
        let ball = object(&sphere([0.0, 0.0, 1.0], 1.0), ball, [0.0; 3]);
        let sky = object(&sphere([0.0, 0.0, 0.0], 50.0), &diffuse(0.0), [0.1, 0.5, 1.0]);
        let matte_free = scene(&[camera([0.2, 0.3, 5.0], [0.1, 0.4, 1.0]), ball.clone(), sky.clone()]);
        let (whitted, _) = mean(&render(&matte_free, "whitted", 4096, Some(32)), 1);
        for estimator in full_estimators() {
            let (found, error) = mean(&render(&matte_free, estimator, 400_000, None), 1);
            let most = critical_value(sidak(1e-3, 12).unwrap()).unwrap();
            assert!(most * error < 5e-3 * whitted, "{what}, {estimator}: no power, {error} of {whitted}");
            assert!((found - whitted).abs() < most * error + 1e-6, "{what}, {estimator}: {found} and {whitted}");
        }
    }
    // A lit wall, seen past the ball: no other surface lights it.
    let lit = scene(&[camera([0.2, 0.3, 5.0], [2.0, 2.0, -3.0]), wall, light]);
    let (whitted, _) = mean(&render(&lit, "whitted", 4096, None), 1);
    for estimator in full_estimators() {
        let (found, error) = mean(&render(&lit, estimator, 4096, None), 1);
        assert!(error < 1e-6 && (found - whitted).abs() < 1e-6 * whitted, "{estimator}: {found} and {whitted}");
    }
}

/// Whitted's estimator omits indirect diffuse light: in a closed diffuse sphere it sees only the wall's own emission.
#[test]
fn leaves_out_light_from_matte_surfaces() {
    let wall = object(&sphere([0.0; 3], 1.0), &diffuse(0.5), [1.0; 3]);
    let scene = scene(&[camera([0.1, 0.2, 0.3], [1.0, 0.0, 0.0]), wall]);
    assert_eq!(mean(&render(&scene, "whitted", 4096, None), 0).0, 1.0);
}

/// A sampler that panics instead of returning a number.
struct Never;

impl Sampler for Never {
    fn pair(&self, at: Address) -> [f64; 2] {
        panic!("a number was drawn for {at:?}")
    }
}

#[test]
fn nothing_is_left_to_chance() {
    for name in ["report-c", "report-d", "cornell", "cornell-fog", "cornell-lens"] {
        let scene = load(name).unwrap();
        let view = scene.camera.view(32, 24);
        let mut light = 0.0;
        for pixel in 0..32 * 24 {
            let ray = view.ray::<AllEffects>(pixel % 32, pixel / 32, 0, [0.5; 2], || [0.5; 2]);
            let key = SampleKey { seed: 1, pixel, sample: 0 };
            let estimator = Whitted::new(Options::default());
            light += estimator.sample::<_, AllEffects, ()>(&scene, ray, key, &Never, &mut ()).g;
        }
        assert!(light > 0.0, "{name} is dark");
    }
}
