//! Point lights over a plane, where nothing is left to chance, by every estimator.

use super::estimate::{assert_exact, camera, diffuse, mean, object, plane, point_light, render, scene, view};
use pathmark::estimator::ESTIMATORS;
use std::f64::consts::PI;

fn floor(albedo: f64) -> String {
    object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(albedo), [0.0; 3])
}

/// A7: rho I cos/(pi d^2).
#[test]
fn light_over_a_plane() {
    for (x, exact) in [(0.0, 0.159_154_943_091_895_34), (1.0, 0.056_269_769_759_819_14)] {
        let scene = scene(&[camera([0.0, 3.0, 1.0], [x, 0.0, 0.0]), point_light([0.0, 1.0, 0.0], 1.0), floor(0.5)]);
        for entry in ESTIMATORS {
            assert_exact(&format!("x {x}, {}", entry.name), &render(&scene, entry.name, 4096, None), 0, exact, 8);
        }
    }
}

/// The inverse-square law: twice as far is a quarter of the light, so the slope over the logarithms is -2.
#[test]
fn light_falls_off_by_the_square() {
    for entry in ESTIMATORS {
        let points: Vec<(f64, f64)> = (0..12)
            .map(|k| {
                let height = 0.25 * f64::from(1 << k);
                let light = point_light([0.0, height, 0.0], 1.0);
                let scene = scene(&[camera([0.0, 0.1, 0.1], [0.0; 3]), light, floor(0.5)]);
                (libm::log2(height), libm::log2(mean(&render(&scene, entry.name, 4096, None), 0).0))
            })
            .collect();
        let n = points.len() as f64;
        let middle = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / n, y + point.1 / n));
        let (mut xx, mut xy) = (0.0, 0.0);
        for (x, y) in points {
            xx += (x - middle.0) * (x - middle.0);
            xy += (x - middle.0) * (y - middle.1);
        }
        assert!((xy / xx + 2.0).abs() < 1e-6, "{}: slope {}", entry.name, xy / xx);
    }
}

/// Lights add up, each is hidden on its own, and what is below the floor does not light it from above.
#[test]
fn lights_add_up_and_are_hidden() {
    let ball = object("{ sphere = { center = [1.0, 1.0, 0.0], radius = 0.25 } }", &diffuse(0.0), [0.0; 3]);
    let parts = [
        camera([0.0, 0.5, 0.5], [0.0; 3]),
        point_light([0.0, 1.0, 0.0], 1.0),
        point_light([0.0, 2.0, 0.0], 2.0),
        point_light([2.0, 2.0, 0.0], 1000.0), // behind the ball
        point_light([0.0, -1.0, 0.0], 1000.0),
        floor(0.5),
        ball,
    ];
    let exact = 0.5 / PI * (1.0 + 2.0 / 4.0);
    for entry in ESTIMATORS {
        assert_exact(entry.name, &render(&scene(&parts), entry.name, 4096, None), 0, exact, 4);
    }
}

/// A light that lies in a surface is hidden by it nowhere: by rounding alone the surface would be nearer for half of the floor.
#[test]
fn a_light_in_a_surface_is_not_hidden_by_it() {
    let ceiling = object(&plane([0.0, 2.0, 0.0], [0.6, 0.8, 0.0]), &diffuse(0.0), [0.0; 3]);
    let wide = view([-0.5, 1.0, 0.5], [-0.5, 0.0, 0.4], [0.0, 0.0, 1.0], 60.0);
    let scene = scene(&[wide, point_light([0.0, 2.0, 0.0], 1.0), floor(0.5), ceiling]);
    for entry in ESTIMATORS {
        let outcome = render(&scene, entry.name, 4096, None);
        // Every sample is lit from about the same distance, so a hidden one would show in its pixel's mean.
        for pixel in outcome.film.pixels() {
            let mean = pixel.sum[0] / f64::from(pixel.count);
            let spread = pixel.square[0] / f64::from(pixel.count) - mean * mean;
            assert!(mean > 0.0 && spread < 0.01 * mean * mean, "{}: mean {mean}, spread {spread}", entry.name);
        }
    }
}
