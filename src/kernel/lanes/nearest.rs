//! The first thing that each ray meets.

use super::Lanes;
use super::packet::{LanesOf, Rays, vector};
use crate::kernel::Counts;
use crate::math::{Ray, Vec3, first_root};
use crate::scene::{Standpoint, Tests};
use crate::simd::Float;

impl Lanes {
    /// Distance and number of the first primitive along each ray; the number is -1 where there is none. What is in lanes that are not `wanted`
    /// is not looked at. Ties go to the lowest number, as with one path at a time.
    #[inline(always)]
    pub(super) fn nearest<V: Float>(&self, rays: &Rays<V>, wanted: u32, counts: &mut Counts) -> (V, V) {
        if !self.scans {
            self.one_by_one(rays, wanted, counts)
        } else if V::IS_DOUBLE {
            self.scan(rays)
        } else {
            self.singles.scan(rays)
        }
    }

    /// Tests every sphere.
    #[inline(always)]
    fn scan<V: Float>(&self, rays: &Rays<V>) -> (V, V) {
        let mut found = Found::nothing();
        for (sphere, number) in self.scene.primitives.spheres.iter().zip(0_u32..) {
            let offset = rays.ray.origin - Vec3::splat(sphere.center);
            let root = first_root(offset, rays.ray.direction, V::splat(1.0), V::splat(sphere.radius));
            found.take(rays, V::splat(number.into()), root);
        }
        found.best()
    }

    /// Asks the scene for each ray.
    #[inline(always)]
    fn one_by_one<V: Float>(&self, rays: &Rays<V>, wanted: u32, counts: &mut Counts) -> (V, V) {
        let (mut nearest, mut primitive) = (V::splat(f64::INFINITY), V::splat(-1.0));
        let mut tests = Tests::default();
        for lane in LanesOf(wanted) {
            let ray = Ray { origin: vector(&rays.ray.origin, lane), direction: vector(&rays.ray.direction, lane) };
            let from = rays.from.lane(lane);
            // Only what goes inside has another root; what is flat has none on either side.
            let inside = !rays.own_root.lane(lane).is_nan();
            let from = (from >= 0.0).then_some(Standpoint { primitive: from as u32, inside });
            let found = self.scene.nearest(&ray, from, &mut tests);
            if found.primitive != u32::MAX {
                nearest.set_lane(lane, found.t);
                primitive.set_lane(lane, f64::from(found.primitive));
            }
        }
        counts.box_tests += tests.boxes;
        counts.primitive_tests += tests.primitives;
        (nearest, primitive)
    }
}

/// What the rays met so far.
pub(super) struct Found<V: Float> {
    nearest: V,
    primitive: V,
}

impl<V: Float> Found<V> {
    #[inline(always)]
    pub(super) fn nothing() -> Self {
        Self { nearest: V::splat(f64::INFINITY), primitive: V::splat(-1.0) }
    }

    /// A root of a primitive; that of the one on which a ray starts is known.
    #[inline(always)]
    pub(super) fn take(&mut self, rays: &Rays<V>, number: V, root: V) {
        let distance = V::select(rays.from.equal(number), rays.own_root, root);
        let is_nearer = V::splat(0.0).lt(distance) & distance.lt(self.nearest);
        self.nearest = V::select(is_nearer, distance, self.nearest);
        self.primitive = V::select(is_nearer, number, self.primitive);
    }

    /// Distance and number of the primitive.
    #[inline(always)]
    pub(super) fn best(&self) -> (V, V) {
        (self.nearest, self.primitive)
    }
}
