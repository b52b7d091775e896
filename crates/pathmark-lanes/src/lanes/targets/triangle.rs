//! Triangular lights in lanes, as in [`TriangleTarget`].

use super::{Chosen, Directions, Met, Start};
use crate::simd::{Float, Table};
use pathmark_tracer::math::{Precision, Ray, Vec3, dot};
use pathmark_tracer::scene::{AnyTarget, Lights, TriangleTarget, per_steradian, point_of};

/// The triangles among the lights.
pub(super) struct Triangles {
    corners: Table,
    edges: [Table; 2],
    normals: Table,
}

/// A row of a table of vectors for each lane.
#[inline(always)]
fn vector<V: Float>(table: &Table, row: V) -> Vec3<V> {
    let [x, y, z, _] = V::rows(table, row);
    Vec3 { x, y, z }
}

impl Triangles {
    /// The triangles among the lights, in tables with a row for each light; `None` if there are none.
    pub(super) fn of(lights: &Lights, precision: Precision) -> Option<Self> {
        let table = |part: fn(&TriangleTarget) -> Vec3| {
            let rows = lights.lights.iter().map(|light| match &light.target {
                AnyTarget::Triangle(target) => {
                    let Vec3 { x, y, z } = part(target);
                    [x, y, z, 0.0]
                }
                AnyTarget::Sphere(_) => [0.0; 4],
            });
            Table::new(rows, precision)
        };
        let is_there = lights.lights.iter().any(|light| matches!(light.target, AnyTarget::Triangle(_)));
        is_there.then(|| Self {
            corners: table(|target| target.corner),
            edges: [table(|target| target.edges[0]), table(|target| target.edges[1])],
            normals: table(|target| target.normal),
        })
    }

    #[inline(always)]
    pub(super) fn aim<V: Float>(&self, light: &Chosen<V>, start: &Start<V>, place: [V; 2]) -> Directions<V> {
        let edges = [vector(&self.edges[0], light.light), vector(&self.edges[1], light.light)];
        let towards = point_of(vector(&self.corners, light.light), edges, place) - start.point;
        let square = dot(towards, towards);
        let direction = towards * (V::splat(1.0) / square.sqrt());
        let density = per_steradian(square, direction, vector(&self.normals, light.light), light.area);
        Directions { lanes: !start.primitive.equal(light.primitive) & V::splat(0.0).lt(square), direction, density }
    }

    #[inline(always)]
    pub(super) fn density<V: Float>(&self, light: &Chosen<V>, ray: &Ray<V>, met: &Met<V>) -> V {
        per_steradian(met.t * met.t, ray.direction, vector(&self.normals, light.light), light.area)
    }
}
