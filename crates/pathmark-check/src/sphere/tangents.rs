//! Rays with exact answers: along the silhouette, from the surface, from the centre, and with invalid directions.

use super::formulas::{first_hits, smallpt_first_root};
use crate::math::Vec3;
use crate::{Trials, U};

pub(super) const FORWARD: [f64; 3] = [1.0, 0.0, 0.0];
pub(super) const BESIDE: [f64; 3] = [-5.0, 0.25, 0.0];
const ORIGIN: Vec3 = Vec3::new(0.0, 0.0, 0.0);

/// Checks a ray at the unit sphere around the origin, whose answer is known to the bit.
pub(super) fn same(trials: &mut Trials, origin: [f64; 3], direction: [f64; 3], expected: Option<f64>) {
    for (way, found) in first_hits(Vec3::from(origin), Vec3::from(direction), ORIGIN, 1.0) {
        trials.same(format!("{way}, from {origin:?} along {direction:?}"), &expected, &found);
    }
}

pub(super) fn beside_the_tangent(trials: &mut Trials) {
    let origin = [-2.0, 1.0 + 2.0 * U, 0.0];
    same(trials, origin, FORWARD, None);
    let smallpt = smallpt_first_root(Vec3::from(origin), Vec3::from(FORWARD), 1.0, 0.0);
    trials.holds("smallpt's formula", "a false hit, or this ray would prove nothing", smallpt, smallpt > 0.0);
}

pub(super) fn from_the_centre(trials: &mut Trials) {
    for direction in [FORWARD, [0.0, 0.0, -1.0], [-0.0, 1.0, 0.0], [0.6, 0.8, 0.0], [0.48, -0.6, 0.64]] {
        for radius in [1.0, 1e-90, 1e90] {
            for (way, found) in first_hits(ORIGIN, Vec3::from(direction), ORIGIN, radius) {
                let variant = format!("{way}, radius {radius:e}, along {direction:?}");
                trials.close(variant, radius, found.unwrap_or(f64::NAN), 4.0 * U * radius);
            }
        }
    }
}

/// The formulas promise nothing for a direction whose square overflows or underflows; they still find no wrong hit.
pub(super) fn too_long(trials: &mut Trials) {
    let direction = [1e200, 0.0, 0.0];
    same(trials, BESIDE, direction, None);
    let smallpt = smallpt_first_root(Vec3::from(BESIDE), Vec3::from(direction), 1.0, 0.0);
    trials.same("smallpt's formula, or this ray would prove nothing", &f64::INFINITY, &smallpt);
}

pub(super) fn no_numbers(trials: &mut Trials) {
    same(trials, BESIDE, [0.0; 3], None);
    same(trials, [0.0; 3], [0.0; 3], None);
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let (mut direction, mut origin) = (FORWARD, BESIDE);
            (direction[axis], origin[axis]) = (x, x);
            same(trials, BESIDE, direction, None);
            same(trials, origin, FORWARD, None);
        }
    }
}

pub(super) fn beyond_the_sentinel(trials: &mut Trials) {
    for (way, found) in first_hits(Vec3::new(-1e21, 0.0, 0.0), Vec3::from(FORWARD), ORIGIN, 1.0) {
        trials.close(way, 1e21, found.unwrap_or(f64::NAN), 8.0 * U * 1e21);
    }
}
