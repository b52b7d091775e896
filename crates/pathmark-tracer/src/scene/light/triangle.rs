//! A triangle as a target: points are sampled uniformly over its area (Turk, "Generating Random Points in Triangles",
//! 1990). It emits on both sides.

use crate::math::{Ray, Real, Vec3, dot};
use crate::scene::{Hit, Primitive, Triangle};

/// A triangle with the data for aiming at it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleTarget {
    /// The corner that the edges start from.
    pub corner: Vec3,
    /// The edges from there to the other corners.
    pub edges: [Vec3; 2],
    /// The unit normal.
    pub normal: Vec3,
    area: f64,
}

/// Samples a point of the triangle with that corner and the edges from there.
#[inline(always)]
pub fn point_of<T: Real>(corner: Vec3<T>, [e, f]: [Vec3<T>; 2], [u, v]: [T; 2]) -> Vec3<T> {
    let root = u.sqrt();
    corner + e * (root * (T::splat(1.0) - v)) + f * (root * v)
}

/// Returns the density per steradian of a direction to a point on a flat light of that area and normal; `square` is the
/// squared distance to the point.
#[inline(always)]
pub fn per_steradian<T: Real>(square: T, direction: Vec3<T>, normal: Vec3<T>, area: T) -> T {
    square / (dot(direction, normal).abs() * area)
}

impl TriangleTarget {
    /// `None` if its area is too small or too large to divide by.
    pub(super) fn new(triangle: &Triangle) -> Option<Self> {
        let [a, b, c] = triangle.corners;
        let edges = [b - a, c - a];
        let cross = edges[0].cross(edges[1]);
        let area = 0.5 * dot(cross, cross).sqrt();
        area.is_normal().then(|| Self { corner: a, edges, normal: triangle.normal(a), area })
    }

    #[inline(always)]
    pub(super) fn aim(&self, point: Vec3, own: Option<bool>, u: [f64; 2]) -> Option<(Vec3, f64)> {
        let towards = point_of(self.corner, self.edges, u) - point;
        let square = dot(towards, towards);
        let direction = towards * (1.0 / square.sqrt());
        // A flat surface is not visible from itself.
        (own.is_none() && square > 0.0).then(|| (direction, per_steradian(square, direction, self.normal, self.area)))
    }

    #[inline(always)]
    pub(super) fn density(&self, ray: &Ray, _own: Option<bool>, hit: &Hit) -> f64 {
        per_steradian(hit.t * hit.t, ray.direction, self.normal, self.area)
    }

    pub(super) fn area(&self) -> f64 {
        self.area
    }
}
