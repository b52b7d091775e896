//! A ray's nearest hit so far.

use crate::lanes::rays::LanesOf;
use crate::simd::{Float, Mask};

/// A ray's nearest hit so far: distance and number of the primitive, -1 for none.
pub(super) struct Best {
    pub(super) nearest: f64,
    pub(super) primitive: f64,
}

impl Best {
    /// Takes a distance to the primitive with this number.
    #[inline(always)]
    pub(super) fn take_one(&mut self, distance: f64, primitive: f64) {
        let is_lower = distance == self.nearest && primitive < self.primitive;
        let is_first = distance > 0.0 && (distance < self.nearest || is_lower);
        self.nearest = if is_first { distance } else { self.nearest };
        self.primitive = if is_first { primitive } else { self.primitive };
    }

    /// Takes distances to the primitives with these numbers, lane by lane, for rays that mostly meet one or none.
    #[inline(always)]
    pub(super) fn take_few<V: Float>(&mut self, numbers: &[V::One], distance: V) {
        let ahead = V::splat(0.0).lt(distance) & distance.le(V::splat(self.nearest));
        for lane in LanesOf(ahead.bits()) {
            self.take_one(distance.lane(lane), numbers[lane].into());
        }
    }

    /// Takes distances likewise, for rays that often meet several.
    #[inline(always)]
    pub(super) fn take<V: Float>(&mut self, numbers: &[V::One], distance: V) {
        let ahead = V::splat(0.0).lt(distance) & distance.le(V::splat(self.nearest));
        if ahead.any() {
            let nearest = V::select(ahead, distance, V::splat(f64::INFINITY)).least();
            for lane in LanesOf((ahead & distance.equal(V::splat(nearest))).bits()) {
                let primitive = numbers[lane].into();
                if nearest < self.nearest || primitive < self.primitive {
                    *self = Self { nearest, primitive };
                }
            }
        }
    }
}
