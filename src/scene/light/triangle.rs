//! A triangle as a target: points evenly over its area (Turk, "Generating Random Points in Triangles", 1990). It gives off light on both
//! sides.

use super::Target;
use crate::math::{Ray, Vec3, dot};
use crate::scene::{Hit, Primitive, Triangle};

/// The triangle with what aiming at it needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TriangleTarget {
    corner: Vec3,
    edges: [Vec3; 2],
    normal: Vec3,
    area: f64,
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
    fn per_steradian(&self, square: f64, direction: Vec3) -> f64 {
        square / (dot(direction, self.normal).abs() * self.area)
    }
}

impl Target for TriangleTarget {
    #[inline(always)]
    fn aim(&self, point: Vec3, own: Option<bool>, [u, v]: [f64; 2]) -> Option<(Vec3, f64)> {
        let root = u.sqrt();
        let [e, f] = self.edges;
        let towards = self.corner + e * (root * (1.0 - v)) + f * (root * v) - point;
        let square = dot(towards, towards);
        let direction = towards * (1.0 / square.sqrt());
        // Nothing flat is seen from itself.
        (own.is_none() && square > 0.0).then(|| (direction, self.per_steradian(square, direction)))
    }

    #[inline(always)]
    fn density(&self, ray: &Ray, _own: Option<bool>, hit: &Hit) -> f64 {
        self.per_steradian(hit.t * hit.t, ray.direction)
    }

    fn area(&self) -> f64 {
        self.area
    }
}
