//! A point light in a surface, with every estimator.

use crate::estimate::{diffuse, object, plane, point_light, render, scene, view};
use pathmark::estimator::ESTIMATORS;

fn floor(albedo: f64) -> String {
    object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(albedo), [0.0; 3])
}

/// A surface never hides a light that lies in it. By rounding alone, the surface would be nearer for half of the
/// floor.
#[test]
fn a_light_in_a_surface_is_not_hidden_by_it() {
    let ceiling = object(&plane([0.0, 2.0, 0.0], [0.6, 0.8, 0.0]), &diffuse(0.0), [0.0; 3]);
    let wide = view([-0.5, 1.0, 0.5], [-0.5, 0.0, 0.4], [0.0, 0.0, 1.0], 60.0);
    let scene = scene(&[wide, point_light([0.0, 2.0, 0.0], 1.0), floor(0.5), ceiling]);
    for entry in ESTIMATORS {
        let outcome = render(&scene, entry.name, 4096, None);
        // Every sample is lit from about the same distance, so a hidden one would change its pixel's mean.
        for pixel in outcome.film.pixels() {
            let mean = pixel.sum[0] / f64::from(pixel.count);
            let spread = pixel.square[0] / f64::from(pixel.count) - mean * mean;
            assert!(mean > 0.0 && spread < 0.01 * mean * mean, "{}: mean {mean}, spread {spread}", entry.name);
        }
    }
}
