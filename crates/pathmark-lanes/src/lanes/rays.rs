//! The rays of a packet, and what they have met so far.

use crate::simd::Float;
use pathmark_tracer::math::Ray;

/// The rays of a packet, and where they start.
#[derive(Clone, Copy)]
pub(super) struct Rays<V: Float> {
    pub(super) ray: Ray<V>,
    /// Number of the primitive that a ray starts on; -1 if on none.
    pub(super) from: V,
    /// Distance to where the ray meets that primitive again; NaN if it does not.
    pub(super) own_root: V,
}

/// The nearest primitives so far.
pub(super) struct Found<V: Float> {
    pub(super) nearest: V,
    pub(super) primitive: V,
}

impl<V: Float> Found<V> {
    #[inline(always)]
    pub(super) fn nothing() -> Self {
        Self { nearest: V::splat(f64::INFINITY), primitive: V::splat(-1.0) }
    }

    /// Takes a root of a primitive. If the ray starts on that primitive, its known root is taken instead.
    #[inline(always)]
    pub(super) fn take(&mut self, rays: &Rays<V>, number: V, root: V) {
        self.take_from_anywhere(number, V::select(rays.from.equal(number), rays.own_root, root));
    }

    /// Takes a distance to a primitive, even if the ray starts on it.
    #[inline(always)]
    pub(super) fn take_from_anywhere(&mut self, number: V, distance: V) {
        let is_nearer = V::splat(0.0).lt(distance) & distance.lt(self.nearest);
        self.replace(is_nearer, number, distance);
    }

    /// Takes a distance likewise, for primitives in any order: among equally near ones the lowest number wins.
    #[inline(always)]
    pub(super) fn take_in_any_order(&mut self, number: V, distance: V) {
        let comes_first = distance.equal(self.nearest) & number.lt(self.primitive);
        let is_nearer = V::splat(0.0).lt(distance) & (distance.lt(self.nearest) | comes_first);
        self.replace(is_nearer, number, distance);
    }

    #[inline(always)]
    fn replace(&mut self, is_nearer: V::Mask, number: V, distance: V) {
        self.nearest = V::select(is_nearer, distance, self.nearest);
        self.primitive = V::select(is_nearer, number, self.primitive);
    }
}

/// The lanes of a mask, from the lowest.
pub(super) struct LanesOf(pub(super) u32);

impl Iterator for LanesOf {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}
