//! Inside closed spheres, where every point sees every other by the same form factor.

use super::estimate::{arriving_estimators, assert_exact, camera, diffuse, object, point_light, render, scene, sphere};
use super::unsplit_estimators;
use std::f64::consts::PI;

fn hollow(albedo: f64, emission: f64) -> String {
    object(&sphere([0.0; 3], 1.0), &diffuse(albedo), [emission; 3])
}

/// A1: Le/(1 - rho).
#[test]
fn glowing_wall() {
    for (rho, samples) in [(0.1, 4096), (0.5, 20_000), (0.75, 200_000), (0.9, 800_000)] {
        let scene = scene(&[camera([0.1, 0.2, 0.3], [1.0, 0.0, 0.0]), hollow(rho, 1.0)]);
        for estimator in arriving_estimators() {
            let outcome = render(&scene, estimator, samples, None);
            assert_exact(&format!("rho {rho}, {estimator}"), &outcome, 0, 1.0 / (1.0 - rho), 16);
            assert_eq!(outcome.counts.escaped, 0);
        }
    }
}

/// A3: a point light in the middle, rho I/(pi R^2 (1 - rho)). The intensity pi in a unit sphere of albedo 1/2 makes exactly 1.
#[test]
fn light_in_the_middle() {
    for (radius, rho, exact) in [(1.0, 0.5, 1.0), (2.0, 0.8, 1.0)] {
        let parts = [
            camera([0.1, 0.2, 0.3], [radius, 0.0, 0.0]),
            point_light([0.0; 3], PI),
            object(&sphere([0.0; 3], radius), &diffuse(rho), [0.0; 3]),
        ];
        for estimator in arriving_estimators() {
            let outcome = render(&scene(&parts), estimator, 400_000, None);
            assert_exact(&format!("radius {radius}, {estimator}"), &outcome, 0, exact, 8);
        }
    }
}

/// A4: the integrating sphere with a black source of radius 1/2 in its middle: rho k Le/(1 - rho (1 - k)), k = 1/4.
#[test]
fn integrating_sphere() {
    let source = object(&sphere([0.0; 3], 0.5), &diffuse(0.0), [1.0; 3]);
    let scene = scene(&[camera([0.0, 0.75, 0.0], [0.6, 0.8, 0.0]), hollow(0.5, 0.0), source]);
    for estimator in unsplit_estimators() {
        assert_exact(estimator, &render(&scene, estimator, 6_200_000, None), 0, 0.2, 4);
    }
}

/// A5: a point light off the middle. The indirect light is the same everywhere, the direct is not.
#[test]
fn light_off_the_middle() {
    let near = [0.0, 0.0, 1.0];
    let cases = [
        (0.5, 0.5, near, 0.795_774_715_459_476_7, 300_000),
        (0.5, 0.5, [0.0, 0.0, -1.0], 0.229_890_473_354_959_93, 1_200_000),
        (0.5, 0.5, [1.0, 0.0, 0.0], 0.273_036_950_038_443_66, 1_200_000),
        (0.9, 0.8, near, 26.483_382_530_491_384, 60_000),
    ];
    for (z, rho, spot, exact, samples) in cases {
        let scene = scene(&[camera([0.1, 0.3, 0.2], spot), point_light([0.0, 0.0, z], 1.0), hollow(rho, 0.0)]);
        for estimator in arriving_estimators() {
            let outcome = render(&scene, estimator, samples, None);
            assert_exact(&format!("z {z}, {spot:?}, {estimator}"), &outcome, 0, exact, 16);
        }
    }
}
