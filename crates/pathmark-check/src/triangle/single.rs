//! Single triangles and rays at points.

use crate::bare_scene::scene_of;
use crate::math::{Ray, Vec3};
use crate::scene::{Primitive, Primitives, Scene, Triangle};

/// The rounding unit.
pub(super) const U: f64 = f64::EPSILON / 2.0;

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
