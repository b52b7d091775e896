//! The first thing that each ray meets.

use super::Lanes;
use super::packet::{LanesOf, Rays, vector};
use crate::kernel::Counts;
use crate::math::Ray;
use crate::scene::{Standpoint, Tests};
use crate::simd::{Float, Mask};

impl Lanes {
    /// Distance and number of the first primitive along each ray; the number is -1 where there is none. What is in lanes that are not `wanted`
    /// is not looked at. Ties go to the lowest number, as with one path at a time.
    #[inline(always)]
    pub(super) fn nearest<V: Float>(&self, rays: &Rays<V>, wanted: u32, counts: &mut Counts) -> (V, V) {
        let (mut found, left) = if !self.scans {
            (Found::nothing(), wanted)
        } else if V::IS_DOUBLE {
            let (found, is_sure) = self.filter.nearest(&self.tables, rays);
            (found, wanted & !is_sure.bits())
        } else {
            (self.singles.scan(rays), 0)
        };
        if left != 0 {
            self.one_by_one(rays, left, &mut found, counts);
        }
        (found.nearest, found.primitive)
    }

    /// Asks the scene for each ray.
    #[inline(never)]
    fn one_by_one<V: Float>(&self, rays: &Rays<V>, wanted: u32, found: &mut Found<V>, counts: &mut Counts) {
        let mut tests = Tests::default();
        for lane in LanesOf(wanted) {
            let ray = Ray { origin: vector(&rays.ray.origin, lane), direction: vector(&rays.ray.direction, lane) };
            let from = rays.from.lane(lane);
            // Only what goes inside has another root; what is flat has none on either side.
            let inside = !rays.own_root.lane(lane).is_nan();
            let from = (from >= 0.0).then_some(Standpoint { primitive: from as u32, inside });
            let nearest = self.scene.nearest(&ray, from, &mut tests);
            found.nearest.set_lane(lane, nearest.t);
            found.primitive.set_lane(lane, if nearest.primitive == u32::MAX { -1.0 } else { nearest.primitive.into() });
        }
        counts.box_tests += tests.boxes;
        counts.primitive_tests += tests.primitives;
    }
}

/// What the rays met so far.
pub(super) struct Found<V: Float> {
    pub(super) nearest: V,
    pub(super) primitive: V,
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
}
