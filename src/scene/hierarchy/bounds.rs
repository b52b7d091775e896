//! Boxes with faces along the axes, and rays against them.

use crate::math::{Ray, Vec3};

/// A closed box; it may be flat, or a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The smallest coordinates.
    pub low: [f64; 3],
    /// The largest coordinates.
    pub high: [f64; 3],
}

impl Bounds {
    /// The box around nothing, which any other contains.
    pub const EMPTY: Self = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    /// The smallest box around some points.
    pub fn of_points(points: &[Vec3]) -> Self {
        points.iter().fold(Self::EMPTY, |bounds, point| {
            let point = [point.x, point.y, point.z];
            bounds.and(&Self { low: point, high: point })
        })
    }

    /// The smallest box around both.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        let mut both = *self;
        for axis in 0..3 {
            both.low[axis] = both.low[axis].min(other.low[axis]);
            both.high[axis] = both.high[axis].max(other.high[axis]);
        }
        both
    }

    /// Its middle along an axis; halves first, so that it cannot overflow.
    pub fn middle(&self, axis: usize) -> f64 {
        0.5 * self.low[axis] + 0.5 * self.high[axis]
    }

    /// Half of its surface; 0 if it is empty.
    pub fn half_area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| (self.high[axis] - self.low[axis]).max(0.0));
        x * y + y * z + z * x
    }
}

/// How far outside a box a ray may pass and still be let in. It covers what rounding can do to the box test and to the tests of the
/// primitives in it: at most some 30 units in the last place of the largest coordinate that takes part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Margin(f64);

const RELATIVE: f64 = 1.0 / (1u64 << 47) as f64;

impl Margin {
    /// For primitives within these bounds.
    pub(super) fn of(bounds: &Bounds) -> Self {
        let largest = bounds.low.iter().chain(&bounds.high).fold(0.0, |largest: f64, x| largest.max(x.abs()));
        Self(if largest < f64::INFINITY { RELATIVE * largest } else { 0.0 })
    }
}

/// A ray, made ready for boxes.
#[derive(Clone, Copy)]
pub(super) struct Slabs {
    /// The origin, moved back and forth by the margin: where distances to near and far faces are taken from.
    near: [f64; 3],
    far: [f64; 3],
    /// One over the direction, infinite with a plus sign where that is zero.
    inverse: [f64; 3],
    /// Whether it goes towards smaller coordinates.
    pub(super) backward: [bool; 3],
}

impl Slabs {
    #[inline(always)]
    pub(super) fn new(ray: &Ray, Margin(own): Margin) -> Self {
        let origin = [ray.origin.x, ray.origin.y, ray.origin.z];
        let direction = [ray.direction.x, ray.direction.y, ray.direction.z];
        let margin = own + RELATIVE * origin[0].abs().max(origin[1].abs()).max(origin[2].abs());
        let backward = direction.map(|d| d < 0.0);
        let (mut near, mut far) = (origin, origin);
        for axis in 0..3 {
            let outwards = if backward[axis] { -margin } else { margin };
            near[axis] += outwards;
            far[axis] -= outwards;
        }
        // Adding zero turns minus zero into zero, or the near and far faces would change places.
        Self { near, far, inverse: direction.map(|d| 1.0 / (d + 0.0)), backward }
    }

    /// Whether the ray enters the box, no later than at `limit`.
    ///
    /// A ray along a face gives 0 times infinity, NaN, for that axis, and `max` and `min` then keep what the other axes say: it is let in.
    #[inline(always)]
    pub(super) fn enters(&self, bounds: &Bounds, limit: f64) -> bool {
        let (mut enter, mut leave) = (0.0_f64, limit);
        for axis in 0..3 {
            let (first, last) = if self.backward[axis] {
                (bounds.high[axis], bounds.low[axis])
            } else {
                (bounds.low[axis], bounds.high[axis])
            };
            enter = ((first - self.near[axis]) * self.inverse[axis]).max(enter);
            leave = ((last - self.far[axis]) * self.inverse[axis]).min(leave);
        }
        enter <= leave
    }
}
