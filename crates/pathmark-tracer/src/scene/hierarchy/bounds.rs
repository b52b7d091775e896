//! Axis-aligned bounding boxes, and the test of rays against them.

use crate::math::{Ray, Vec3};

/// A closed box; it may be flat, or a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Bounds {
    /// The empty box, which every other box contains.
    pub const EMPTY: Self = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    /// The smallest box around some points.
    pub fn of_points(points: &[Vec3]) -> Self {
        points.iter().fold(Self::EMPTY, |bounds, point| {
            let point = [point.x, point.y, point.z];
            bounds.and(&Self { low: point, high: point })
        })
    }

    /// The smallest box around both.
    #[inline(always)]
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        let mut both = *self;
        for axis in 0..3 {
            // Comparisons instead of `min` and `max`, which take three times as long because they handle NaN.
            let (low, high) = (other.low[axis], other.high[axis]);
            both.low[axis] = if low < both.low[axis] { low } else { both.low[axis] };
            both.high[axis] = if high > both.high[axis] { high } else { both.high[axis] };
        }
        both
    }

    /// Returns its centre along an axis. It halves before it adds, so that it cannot overflow.
    pub fn middle(&self, axis: usize) -> f64 {
        0.5 * self.low[axis] + 0.5 * self.high[axis]
    }

    /// Returns the box with its share of the [`padding`] on every side: as far as rounding can move it or a primitive
    /// in it.
    #[must_use]
    pub(super) fn padded(&self) -> Self {
        self.grown(padding(f64::MANTISSA_DIGITS) * self.largest())
    }

    /// Returns the box with every side moved outwards by `by`.
    #[must_use]
    pub fn grown(&self, by: f64) -> Self {
        Self { low: self.low.map(|x| x - by), high: self.high.map(|x| x + by) }
    }

    /// Returns its largest absolute coordinate.
    pub fn largest(&self) -> f64 {
        self.low.iter().chain(&self.high).fold(0.0, |largest, x| largest.max(x.abs()))
    }

    pub(super) const fn faces(&self) -> Faces {
        [self.low, self.high]
    }

    /// Whether a ray meets the closed box, or misses it by at most 2^-47 times the largest coordinate of the box plus
    /// the largest of the ray's origin.
    pub fn meets(&self, ray: &Ray) -> bool {
        Slabs::new(ray).enter(&self.padded().faces(), f64::INFINITY).is_some()
    }

    /// Returns half of its surface area; 0 if it is empty.
    pub fn half_area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| (self.high[axis] - self.low[axis]).max(0.0));
        x * y + y * z + z * x
    }
}

/// Returns the largest distance outside a box at which a ray still counts as hitting it, in units of the sum of the
/// largest coordinates of the box and of the ray's origin. Numbers have `digits` binary digits. The padding covers the
/// rounding errors of the box test and of the tests of its primitives: at most some 30 ulps.
#[inline]
pub const fn padding(digits: u32) -> f64 {
    64.0 / (1_u64 << digits) as f64
}

/// The smallest and the largest coordinates of a box: an array, so that a direction's sign selects one without a
/// branch.
pub type Faces = [[f64; 3]; 2];

/// A ray prepared for box tests.
#[derive(Clone, Copy)]
pub struct Slabs {
    /// The origin, moved forward and backward by its share of the padding: distances to near and far faces start there.
    near: [f64; 3],
    far: [f64; 3],
    /// One over the direction, plus infinity where the direction is zero.
    inverse: [f64; 3],
    /// Whether the ray leads towards smaller coordinates, for each axis.
    backward: [bool; 3],
}

impl Slabs {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let origin = [ray.origin.x, ray.origin.y, ray.origin.z];
        let direction = [ray.direction.x, ray.direction.y, ray.direction.z];
        let padding = padding(f64::MANTISSA_DIGITS) * origin[0].abs().max(origin[1].abs()).max(origin[2].abs());
        let backward = direction.map(|d| d < 0.0);
        let (mut near, mut far) = (origin, origin);
        for axis in 0..3 {
            let outwards = if backward[axis] { -padding } else { padding };
            near[axis] += outwards;
            far[axis] -= outwards;
        }
        // Adding zero turns minus zero into zero: 1/-0 would exchange the near and far faces.
        Self { near, far, inverse: direction.map(|d| 1.0 / (d + 0.0)), backward }
    }

    /// Returns the distance at which the ray enters the box with these padded faces; `None` if it misses the box or
    /// enters it beyond `limit`.
    ///
    /// A ray along a face gives 0 times infinity, NaN, for that axis. The comparisons then keep the result of the other
    /// axes, so the box is not missed because of this one.
    #[inline(always)]
    pub fn enter(&self, faces: &Faces, limit: f64) -> Option<f64> {
        let (mut enter, mut leave) = (0.0_f64, limit);
        for (axis, backward) in self.backward.into_iter().enumerate() {
            let first = (faces[usize::from(backward)][axis] - self.near[axis]) * self.inverse[axis];
            let last = (faces[usize::from(!backward)][axis] - self.far[axis]) * self.inverse[axis];
            enter = if first > enter { first } else { enter };
            leave = if last < leave { last } else { leave };
        }
        (enter <= leave).then_some(enter)
    }
}
