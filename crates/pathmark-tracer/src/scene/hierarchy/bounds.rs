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
    #[inline(always)]
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        let mut both = *self;
        for axis in 0..3 {
            // Comparisons instead of `min` and `max`, which take three times as long to say what becomes of NaN.
            let (low, high) = (other.low[axis], other.high[axis]);
            both.low[axis] = if low < both.low[axis] { low } else { both.low[axis] };
            both.high[axis] = if high > both.high[axis] { high } else { both.high[axis] };
        }
        both
    }

    /// Its middle along an axis; halves first, so that it cannot overflow.
    pub fn middle(&self, axis: usize) -> f64 {
        0.5 * self.low[axis] + 0.5 * self.high[axis]
    }

    /// The box with its share of the [`padding`] on every side: as far as rounding can move it or a primitive in it.
    #[must_use]
    pub(super) fn padded(&self) -> Self {
        self.grown(padding(f64::MANTISSA_DIGITS) * self.largest())
    }

    /// The box with every side moved outwards.
    #[must_use]
    pub fn grown(&self, by: f64) -> Self {
        Self { low: self.low.map(|x| x - by), high: self.high.map(|x| x + by) }
    }

    /// The largest of its coordinates, whatever their signs.
    pub fn largest(&self) -> f64 {
        self.low.iter().chain(&self.high).fold(0.0, |largest, x| largest.max(x.abs()))
    }

    pub(super) const fn faces(&self) -> Faces {
        [self.low, self.high]
    }

    /// Whether a ray meets the box, which is closed, or passes it by no more than 2^-47 times the largest coordinate of the box plus the
    /// largest of the ray's origin.
    pub fn meets(&self, ray: &Ray) -> bool {
        Slabs::new(ray).enter(&self.padded().faces(), f64::INFINITY).is_some()
    }

    /// Half of its surface; 0 if it is empty.
    pub fn half_area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| (self.high[axis] - self.low[axis]).max(0.0));
        x * y + y * z + z * x
    }
}

/// How far outside a box a ray may pass and still be let in, for each unit of the largest coordinate of the box and of the ray's origin, with numbers
/// of so many digits. It covers what rounding can do to the box test and to the tests of the primitives in it: at most some 30 units in the last place.
pub const fn padding(digits: u32) -> f64 {
    64.0 / (1_u64 << digits) as f64
}

/// The smallest and the largest coordinates of a box: an array, so that a direction's sign can choose without a branch.
pub(crate) type Faces = [[f64; 3]; 2];

/// A ray, made ready for boxes.
#[derive(Clone, Copy)]
pub(crate) struct Slabs {
    /// The origin, moved back and forth by its share of the padding: where distances to near and far faces are taken from.
    near: [f64; 3],
    far: [f64; 3],
    /// One over the direction, infinite with a plus sign where that is zero.
    inverse: [f64; 3],
    /// Whether it goes towards smaller coordinates.
    backward: [bool; 3],
}

impl Slabs {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
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
        // Adding zero turns minus zero into zero, or the near and far faces would change places.
        Self { near, far, inverse: direction.map(|d| 1.0 / (d + 0.0)), backward }
    }

    /// Where the ray enters the box between these faces, which have their padding; `None` if it does not or only beyond `limit`.
    ///
    /// A ray along a face gives 0 times infinity, NaN, for that axis, and the comparisons then keep what the other axes say: it is let in.
    #[inline(always)]
    pub(crate) fn enter(&self, faces: &Faces, limit: f64) -> Option<f64> {
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
