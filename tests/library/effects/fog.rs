//! Fog: single scattering compared with quadrature, attenuation of light, and no fog inside glass.

use crate::estimate::{
    arriving_estimators, assert_exact, camera, diffuse, fog, object, plane, point_light, render, scene, sphere,
};
use pathmark::estimator::ESTIMATORS;
use std::f64::consts::PI;

/// A glowing plane at y = 0.
fn lamp(emission: f64) -> String {
    object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(0.0), [emission; 3])
}

fn above(height: f64) -> String {
    camera([0.0, height, 0.0], [0.0; 3])
}

const CLEAR: &str = "{ dielectric = { eta = 1.0, tint = [1.0, 1.0, 1.0] } }";

/// Light of a point light that fog scatters once towards the camera: the integral over the camera ray, by Simpson's
/// rule.
#[test]
fn single_scattering() {
    let (absorption, scattering, length) = (0.3, 0.5, 4.0);
    let light = [1.0, 1.5, 0.0];
    let both = absorption + scattering;
    let integrand = |t: f64| {
        let d2 = light[0] * light[0] + (length - t - light[1]) * (length - t - light[1]);
        scattering * libm::exp(-both * (t + d2.sqrt())) / (d2 * 4.0 * PI)
    };
    let n = 4000;
    let h = length / f64::from(n);
    let weight = |k: i32| if k == 0 || k == n { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
    let exact = h / 3.0 * (0..=n).map(|k| weight(k) * integrand(f64::from(k) * h)).sum::<f64>();
    let scene = scene(&[above(length), fog(absorption, scattering, 0.0), point_light(light, 1.0), lamp(0.0)]);
    for estimator in arriving_estimators() {
        assert_exact(estimator, &render(&scene, estimator, 1_500_000, Some(1)), 0, exact, 4);
    }
}

/// A point light through fog: attenuation on the way to the plane and on the way to the camera. Whitted's estimator
/// also loses the scattered light, and only that.
#[test]
fn point_light_through_fog() {
    let floor = object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(0.5), [0.0; 3]);
    let parts = |scattering| [above(2.0), fog(0.4, scattering, 0.0), point_light([0.0, 1.0, 0.0], 1.0), floor.clone()];
    let exact = 0.5 / PI * libm::exp(-0.4 * 3.0);
    for entry in ESTIMATORS {
        assert_exact(entry.name, &render(&scene(&parts(0.0)), entry.name, 4096, None), 0, exact, 8);
    }
    let scattered = render(&scene(&parts(0.25)), "whitted", 4096, None);
    assert_exact("scattered", &scattered, 0, exact * libm::exp(-0.25 * 3.0), 8);
}

/// Whitted's estimator sees only the part of the fog's emission that arrives unscattered.
#[test]
fn glow_that_is_scattered_away() {
    let scene = scene(&[above(2.0), fog(0.4, 0.6, 3.0), lamp(0.0)]);
    assert_exact("whitted", &render(&scene, "whitted", 4096, None), 0, 3.0 * 0.4 * (1.0 - libm::exp(-2.0)), 1);
}

/// A slab holds no fog between its two surfaces. Objects that glass encloses are free of fog, whichever surface the
/// light left last.
#[test]
fn no_fog_inside_glass() {
    let up = [0.0, 1.0, 0.0];
    let slab = [
        object(&plane([0.0, 2.0, 0.0], up), CLEAR, [0.0; 3]),
        object(&plane([0.0, 0.5, 0.0], [0.0, -1.0, 0.0]), CLEAR, [0.0; 3]),
    ];
    // The camera is 3 above the lamp; 1.5 of the distance lies in the slab.
    let through = scene(&[vec![above(3.0), fog(0.7, 0.0, 0.0), lamp(1.0)], slab.to_vec()].concat());
    // A diffuse ball in a clear ball, with a point light inside the clear ball.
    let within = scene(&[
        above(3.0),
        fog(0.7, 0.0, 0.0),
        object(&sphere([0.0; 3], 2.0), CLEAR, [0.0; 3]),
        object(&sphere([0.0; 3], 0.5), &diffuse(0.5), [0.0; 3]),
        point_light([0.0, 1.5, 0.0], 1.0),
    ]);
    for (what, scene, exact, samples) in
        [("slab", &through, libm::exp(-0.7 * 1.5), 1_500_000), ("ball", &within, 0.5 / PI * libm::exp(-0.7), 700_000)]
    {
        for entry in ESTIMATORS {
            // Only `bsdf` chooses at random here: whether a path is reflected.
            let samples = if entry.name == "bsdf" { samples } else { 4096 };
            assert_exact(&format!("{what}, {}", entry.name), &render(scene, entry.name, samples, None), 0, exact, 8);
        }
    }
}
