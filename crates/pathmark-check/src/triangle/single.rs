//! Single triangles and rays at points.

use crate::bare_scene::scene_of;
use crate::math::{Ray, Vec3, dot};
use crate::scene::{Primitive, Primitives, Scene, Triangle};

pub(super) fn triangle(corners: [[f64; 3]; 3]) -> Triangle {
    Triangle { corners: corners.map(Vec3::from) }
}

/// The distance, if the ray hits.
pub(super) fn meet(triangle: &Triangle, ray: &Ray) -> Option<f64> {
    Some(triangle.meet(ray, &Triangle::prepare(ray))).filter(|t| *t > 0.0)
}

pub(super) fn scene(triangles: Vec<Triangle>) -> Scene {
    scene_of(Primitives { triangles, ..Primitives::default() })
}

/// A ray towards a point, with a direction of length 1.
pub(super) fn towards(origin: Vec3, target: Vec3) -> Ray {
    Ray { origin, direction: (target - origin).normalized() }
}

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
