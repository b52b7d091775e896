//! Spheres that the scene reader refuses, because their squares leave the range of f64 or they have no normal.

use super::formulas::first_hits;
use crate::math::Vec3;
use crate::refusals::refuses_shape;
use crate::stage::{ANY_CAMERA, DIFFUSE, ball, try_scene};
use crate::{Trials, U};

pub(super) fn radii(trials: &mut Trials, radii: &[&str]) {
    for radius in radii {
        let shape = format!("{{ sphere = {{ center = [5.0, 0.0, 0.0], radius = {radius} }} }}");
        refuses_shape(trials, &shape, "radius", radius);
    }
}

/// Checks that a sphere is read, and that a ray from `away` radii before its centre hits it.
fn is_read_and_met(trials: &mut Trials, center: [f64; 3], radius: f64, away: f64) {
    let scene = try_scene(&[ANY_CAMERA.to_string(), ball("ball", center, radius, DIFFUSE)]);
    let told = scene.as_ref().map_or_else(ToString::to_string, |_| "it is read".to_string());
    trials.holds(format!("radius {radius:e} at {center:?}"), "it is read", told, scene.is_ok());
    let center = Vec3::from(center);
    let origin = center - Vec3::new(away * radius, 0.0, 0.0);
    let expected = (away - 1.0) * radius;
    for (way, found) in first_hits(origin, Vec3::new(1.0, 0.0, 0.0), center, radius) {
        let tolerance = 8.0 * U * (away * radius + 2.0 * center.x.abs());
        trials.close(format!("{way}, radius {radius:e}"), expected, found.unwrap_or(f64::NAN), tolerance);
    }
}

pub(super) fn small_radii(trials: &mut Trials) {
    radii(trials, &["5e-324", "1e-310", "9.9e-101", "nan", "inf", "-inf"]);
    is_read_and_met(trials, [0.0; 3], 1e-100, 3.0);
}

pub(super) fn large(trials: &mut Trials) {
    radii(trials, &["1e200", "1.1e100"]);
    for (center, value) in [("1e160, 0.0, 0.0", "1e160"), ("0.0, 0.0, -1.1e100", "-1.1e100"), ("nan, 0.0, 0.0", "nan")]
    {
        let shape = format!("{{ sphere = {{ center = [{center}], radius = 1.0 }} }}");
        refuses_shape(trials, &shape, "center", value);
    }
    is_read_and_met(trials, [1e100, 0.0, 0.0], 1e100, 1.5);
    is_read_and_met(trials, [0.0; 3], 1e100, 10.0);
}
