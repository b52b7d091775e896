//! The exact distance to a triangle's plane, in double-double arithmetic from the exact corners: n·(a - o) / n·d with
//! n = (b - a) x (c - a). All differences are computed exactly. Exact integers confirm the result in
//! `plane_distance_tests.rs`.

use super::single::{meet, towards};
use crate::double_double::{Dd, two_product};
use crate::math::{Ray, dot};
use crate::random::Random;
use crate::scene::Triangle;
use crate::{Trials, U};

/// The distance, rounded once, and the cosine between normal and direction.
pub(super) fn exact_distance(triangle: &Triangle, ray: &Ray) -> (f64, f64) {
    let one = |x: f64| two_product(x, 1.0);
    let [a, b, c] = triangle.corners.map(|p| [one(p.x), one(p.y), one(p.z)]);
    let [o, d] = [ray.origin, ray.direction].map(|p| [one(p.x), one(p.y), one(p.z)]);
    let minus = |p: [Dd; 3], q: [Dd; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let product = |p: [Dd; 3], q: [Dd; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let (e, f) = (minus(b, a), minus(c, a));
    let n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    let (across, along) = (product(n, minus(a, o)), product(n, d));
    (across.over(along), along.0.abs() / product(n, n).sqrt().0)
}

/// The bound on the error of the distance: (7 + length/height of the triangle) roundings of the largest coordinate,
/// divided by the cosine between ray and normal. A sliver has a larger bound because the weights of its corners are
/// less exact.
pub(super) fn bound(triangle: &Triangle, ray: &Ray, cosine: f64) -> f64 {
    let coordinates = triangle.corners.iter().chain([&ray.origin]).flat_map(|p| [p.x.abs(), p.y.abs(), p.z.abs()]);
    let [a, b, c] = triangle.corners;
    let longest = [b - a, c - b, a - c].map(|edge| dot(edge, edge)).into_iter().fold(0.0, f64::max);
    let cross = (b - a).cross(c - a);
    let length_over_height = longest / dot(cross, cross).sqrt();
    (7.0 + length_over_height) * U * coordinates.fold(0.0, f64::max) / cosine
}

/// A random triangle, and a ray at a point of it.
pub(super) fn aimed(random: &mut Random) -> (Triangle, Ray) {
    let (size, away) = match random.below(4) {
        0 => (1e-6, 1e6),
        1 => (1e9, 1e9),
        2 => (1.0, random.scale(-3.0, 6.0)),
        _ => (random.scale(-6.0, 9.0), random.scale(-6.0, 9.0)),
    };
    let middle = random.direction() * away;
    let triangle = Triangle { corners: [0; 3].map(|_| middle + random.direction() * size) };
    let [a, b, c] = triangle.corners;
    let (u, v) = (random.unit(), random.unit());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    let target = a + (b - a) * u + (c - a) * v;
    (triangle, towards(random.direction() * random.scale(-3.0, 3.0), target))
}

pub(super) fn seven_roundings(trials: &mut Trials) {
    let rays = trials.times(200_000, 10_000_000);
    let mut random = Random::new(0x7707);
    let (mut hits, mut outside, mut worst) = (0, 0, 0.0_f64);
    for _ in 0..rays {
        let (triangle, ray) = aimed(&mut random);
        let (expected, cosine) = exact_distance(&triangle, &ray);
        if triangle.is_degenerate() || cosine < 0.01 {
            continue;
        }
        // Rounding of the target may make a ray miss a triangle of a few ulp.
        let Some(t) = meet(&triangle, &ray) else { continue };
        hits += 1;
        let fraction = (t - expected).abs() / bound(&triangle, &ray, cosine);
        worst = worst.max(fraction);
        outside += u64::from(fraction.is_nan() || fraction > 1.0);
    }
    let told = format!("{outside} of {hits}, the worst at {worst:.3} of its bound");
    trials.holds("f64", "0 hits outside of their bounds", told, outside == 0);
    trials.holds("the rays", "three quarters hit", format_args!("{hits} of {rays}"), 4 * hits > 3 * rays);
}
