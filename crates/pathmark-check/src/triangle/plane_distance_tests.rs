//! The double-double oracle compared with exact integers, on 1e4 of the rays that it judges.

use super::plane_distance::{aimed, exact_distance};
use crate::U;
use crate::fixed_point_tests::{UNIT, cross, dot, fixed, fixed_vector, minus};
use crate::random::Random;
use num_bigint::BigInt;

/// Checks that t n·d equals n·(a - o) to a rounding of t.
#[test]
fn ten_thousand_distances_are_right() {
    let mut random = Random::new(0x7707);
    let mut tried = 0;
    while tried < 10_000 {
        let (triangle, ray) = aimed(&mut random);
        let (t, cosine) = exact_distance(&triangle, &ray);
        if triangle.is_degenerate() || cosine < 0.01 {
            continue;
        }
        tried += 1;
        let [a, b, c] = triangle.corners.map(fixed_vector);
        let n = cross(&minus(&b, &a), &minus(&c, &a));
        let (across, along) = (dot(&n, &minus(&a, &fixed_vector(ray.origin))), dot(&n, &fixed_vector(ray.direction)));
        let off: BigInt = fixed(t) * &along - (across << UNIT);
        let allowed: BigInt = fixed(1.25 * U * t.abs()) * &along;
        assert!(off.magnitude() <= allowed.magnitude(), "{triangle:?} {ray:?}: {t:e}");
    }
}
