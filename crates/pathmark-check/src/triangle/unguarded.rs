//! The test that the watertight one replaces, for comparison in cases and in the price list, never in a kernel.

use crate::math::{Ray, Vec3, dot};

/// Distance to a triangle after Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997, from
/// both sides; NaN for a miss. Each triangle uses its own first corner and edges, so neighbours may disagree about a
/// ray through their shared edge.
#[inline(always)]
pub(crate) fn moller_trumbore([a, b, c]: [Vec3; 3], ray: &Ray) -> f64 {
    let (e, f) = (b - a, c - a);
    let p = ray.direction.cross(f);
    let inverse = 1.0 / dot(e, p);
    let s = ray.origin - a;
    let u = dot(s, p) * inverse;
    let q = s.cross(e);
    let v = dot(ray.direction, q) * inverse;
    if u >= 0.0 && v >= 0.0 && u + v <= 1.0 { dot(f, q) * inverse } else { f64::NAN }
}
