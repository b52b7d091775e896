//! Conservative tests of rays in single precision: against boxes, and whether a ray's line comes near a sphere. They
//! may accept too much but never too little. A register holds twice as many numbers as in double precision, and
//! accepted primitives are tested exactly.
//!
//! Lengths are divided by the scene's size, a power of two, so that no value is out of range. Below, u = 2^-24, and |o|
//! and |b| are the largest coordinates of the ray's origin and of a box. The rounding of a face, the origin, a
//! direction's inverse, their products and the distance of the nearest hit so far moves a face by less than 10 u (|o| +
//! |b|). The rounding of the terms of a ray's closest approach to a sphere's centre moves it by less than 23 u (|o| +
//! |b|). The comparison of both squares counts for 6 u of the radius, which is at most |b|. Boxes, radii and rays have
//! a [`padding`] of 64 u |b| and 64 u |o|.
//!
//! In single precision the exact test of an accepted sphere has the same rounding error as the quick test: together
//! less than 2 (23 + 6) u = 58 u. So every sphere that the exact test meets is accepted, and a tree finds the same as a
//! test of all spheres.
//!
//! A ray meets a sphere at most one radius before, and at most one radius behind, its closest approach to the centre.
//! The computed distance of this approach is off by at most 11 u (|o| + |b|), and by 16 u with the rounding of the
//! radius and of the distance of the nearest hit so far. In single precision a sphere beyond another hit has its root
//! at c/q, with c off by 8 u (|f|² + r²), and q at least the closest approach, which is at least r: the root is off by
//! less than 35 u (|o| + |b|). Both together are less than the padding. So a sphere that is rejected as behind the
//! ray's start or beyond the distance is not met there.
//!
//! The padding also covers triangle tests in single precision, slivers included. A corner in the ray's axes is off by
//! at most 5 u (|o| + |b|). The edge functions of such corners have a relative error of at most 2 u, whatever cancels,
//! so their signs are right. The resulting weights of the corners' distances, none of which is negative, have a
//! relative error of at most 4 u. So the point at the computed distance is within 16 u (|o| + |b|) of the triangle, and
//! the ray enters the triangle's box no farther than there.

use crate::simd::{Float, MOST_LANES};
use pathmark_tracer::math::{Ray, Vec3};
use pathmark_tracer::scene::{Bounds, padding};

/// Rays that start farther away, in sizes of the scene, are not tested here: single precision has no larger numbers
/// than 2^128, and products with a direction's inverse must not exceed these on every axis at once.
const FARTHEST: f64 = (1_u128 << 96) as f64;

/// The smallest coordinate that is assumed for a box: squares of its padding must not underflow.
const SMALLEST: f64 = 1.0 / (1_u64 << 40) as f64;

/// The inverse of the size of a scene: a power of two that scales its largest coordinate to about 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale(pub(super) f64);

impl Scale {
    pub(super) fn of(bounds: &Bounds) -> Self {
        // An empty scene has an infinite box, and any exponent will do.
        let (_, exponent) = libm::frexp(bounds.largest());
        Self(libm::ldexp(1.0, -exponent.clamp(-1000, 1000)))
    }

    /// A distance in sizes of the scene. Boxes that begin beyond the nearest hit so far need no test.
    #[inline(always)]
    pub(super) fn limit(self, distance: f64) -> f32 {
        (distance * self.0) as f32
    }

    fn padding(bounds: &Bounds) -> f64 {
        padding(f32::MANTISSA_DIGITS) * bounds.largest().max(SMALLEST)
    }

    /// The padded box that rays are tested against.
    pub(super) fn padded(self, bounds: &Bounds) -> Bounds {
        let bounds = self.scaled(bounds);
        bounds.grown(Self::padding(&bounds))
    }

    /// The centre of a sphere with this box, and the padded radius that rays are tested against.
    pub(super) fn sphere(self, bounds: &Bounds, center: Vec3, radius: f64) -> [f64; 4] {
        let padding = Self::padding(&self.scaled(bounds));
        let Vec3 { x, y, z } = center * self.0;
        [x, y, z, radius * self.0 + padding]
    }

    fn scaled(self, bounds: &Bounds) -> Bounds {
        Bounds { low: bounds.low.map(|x| x * self.0), high: bounds.high.map(|x| x * self.0) }
    }
}

/// Rays of many lanes.
pub(super) struct AllCoarse {
    rows: [[f32; MOST_LANES]; ROWS],
}

/// Numbers of a ray: direction, its inverse, the offsets of distances to near and to far faces, origin, and padding.
const ROWS: usize = 16;

impl AllCoarse {
    pub(super) const fn empty() -> Self {
        Self { rows: [[0.0; MOST_LANES]; ROWS] }
    }

    /// Returns the lanes whose rays can be tested: those that start within [`FARTHEST`] and have a direction. A box test
    /// of any other ray may give NaN on every axis, and such a ray would meet even the boxes of missing children.
    #[inline(always)]
    pub(super) fn fill<V: Float>(&mut self, ray: &Ray<V>, scale: Scale) -> V::Mask {
        let scale = V::splat(scale.0);
        let (x, y, z) = (ray.origin.x * scale, ray.origin.y * scale, ray.origin.z * scale);
        let padding = V::splat(padding(f32::MANTISSA_DIGITS)) * x.abs().larger(y.abs()).larger(z.abs());
        let axes = [(x, ray.direction.x), (y, ray.direction.y), (z, ray.direction.z)];
        for (axis, &(origin, direction)) in axes.iter().enumerate() {
            let outwards = V::select(direction.lt(V::splat(0.0)), -padding, padding);
            // Adding zero turns minus zero into zero; otherwise the near and far faces would change places.
            let inverse = V::splat(1.0) / (direction + V::splat(0.0));
            self.put(axis, direction);
            self.put(3 + axis, inverse);
            self.put(6 + axis, -((origin + outwards) * inverse));
            self.put(9 + axis, -((origin - outwards) * inverse));
            self.put(12 + axis, origin);
        }
        self.put(15, padding);
        let Vec3 { x: dx, y: dy, z: dz } = ray.direction;
        let away = x.abs() + y.abs() + z.abs();
        let length = dx.abs() + dy.abs() + dz.abs();
        away.lt(V::splat(FARTHEST)) & V::splat(0.5).lt(length) & length.lt(V::splat(2.0))
    }

    #[inline(always)]
    fn put<V: Float>(&mut self, row: usize, values: V) {
        let mut numbers = [V::One::default(); MOST_LANES];
        values.store(&mut numbers);
        for (to, number) in self.rows[row].iter_mut().zip(&numbers).take(V::LANES) {
            let number: f64 = (*number).into();
            *to = number as f32;
        }
    }

    #[inline(always)]
    fn three<W: Float<One = f32>>(&self, first: usize, lane: usize) -> [W; 3] {
        let [x, y, z] = [self.rows[first][lane], self.rows[first + 1][lane], self.rows[first + 2][lane]];
        [W::splat(x.into()), W::splat(y.into()), W::splat(z.into())]
    }

    /// [`Coarse::first`] of the axis whose inverse is in this row.
    #[inline(always)]
    fn first<W: Float>(&self, inverse: usize, lane: usize) -> usize {
        (self.rows[inverse][lane].to_bits() >> 31) as usize * W::LANES
    }

    /// The ray of one lane, repeated in all lanes.
    #[inline(always)]
    pub(super) fn of_lane<W: Float<One = f32>>(&self, lane: usize) -> Coarse<W> {
        Coarse {
            direction: self.three(0, lane),
            inverse: self.three(3, lane),
            near: self.three(6, lane),
            far: self.three(9, lane),
            origin: self.three(12, lane),
            padding: W::splat(self.rows[15][lane].into()),
            first: [self.first::<W>(3, lane), self.first::<W>(4, lane), self.first::<W>(5, lane)],
        }
    }
}

/// One ray.
pub(super) struct Coarse<W> {
    direction: [W; 3],
    inverse: [W; 3],
    near: [W; 3],
    far: [W; 3],
    origin: [W; 3],
    padding: W,
    /// For each axis the place of the faces that the ray meets first, in a row of low faces and then high ones: if it
    /// goes towards smaller coordinates, that of the high ones.
    first: [usize; 3],
}

impl<W: Float<One = f32>> Coarse<W> {
    /// Distances at which the ray enters the boxes with these faces, and whether it does so no farther than `limit`.
    /// For each axis the low faces come first, then the high ones.
    ///
    /// A ray along a face gives NaN for that axis. The comparisons then keep the result of the other axes, so the box
    /// is accepted.
    #[inline(always)]
    pub(super) fn enter(&self, faces: &[f32], limit: f32) -> (W, W::Mask) {
        let (mut enter, mut leave) = (W::splat(0.0), W::splat(limit.into()));
        // With this length and these bounds, the loads need no further checks.
        let faces = &faces[..6 * W::LANES];
        for axis in 0..3 {
            let of_axis = &faces[2 * axis * W::LANES..][..2 * W::LANES];
            let first = self.first[axis] & W::LANES;
            let (first, last) = (&of_axis[first..][..W::LANES], &of_axis[W::LANES - first..][..W::LANES]);
            enter = W::load(first).about_times_plus(self.inverse[axis], self.near[axis]).at_least(enter);
            leave = W::load(last).about_times_plus(self.inverse[axis], self.far[axis]).at_most(leave);
        }
        (enter, enter.le(leave))
    }

    /// Whether the ray misses the spheres with these centres and radii, stored as one row of numbers after the other.
    /// It does if its line misses them, if they are behind its start, or if they are beyond `limit`. `false` for a
    /// sphere that leads to NaN.
    #[inline(always)]
    pub(super) fn passes(&self, spheres: &[f32], limit: f32) -> W::Mask {
        let [dx, dy, dz] = self.direction;
        let x = self.origin[0] - W::load(spheres);
        let y = self.origin[1] - W::load(&spheres[W::LANES..]);
        let z = self.origin[2] - W::load(&spheres[2 * W::LANES..]);
        let radius = W::load(&spheres[3 * W::LANES..]) + self.padding;
        let back = -x.about_times_plus(dx, y.about_times_plus(dy, z * dz));
        let is_off = back.lt(-radius) | W::splat(limit.into()).lt(back - radius);
        let (x, y, z) = (dx.about_times_plus(back, x), dy.about_times_plus(back, y), dz.about_times_plus(back, z));
        is_off | (radius * radius).lt(x.about_times_plus(x, y.about_times_plus(y, z * z)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Mask, Precision, Work, levels, on_level};
    use pathmark_tracer::math::{dot, first_root, unit};
    use pathmark_tracer::sampling::{mix, uniform_sphere};

    /// A ray, a sphere that its line meets, and the distance along the ray of a point of the sphere's box.
    struct Meeting {
        ray: Ray,
        center: Vec3,
        radius: f64,
        distance: f64,
    }

    /// Rays towards spheres of all sizes from near and far. Most go along edges: of spheres seen from the ray's origin,
    /// and of boxes.
    fn meetings() -> Vec<Meeting> {
        let mut count = 0;
        let mut random = || {
            count += 1;
            unit(mix(count))
        };
        let mut all = Vec::new();
        while all.len() < 40_000 {
            let [size, away] = [random(), random()].map(|x| libm::exp2(20.0 * x - 10.0));
            let radius = size.min(1.0);
            // If one of the two is near the scene's origin, the other's padding has to suffice.
            let one = uniform_sphere([random(), random()]) * libm::exp2(-20.0 * random());
            let other = one + uniform_sphere([random(), random()]) * (radius + away);
            let (center, origin) = if all.len() % 2 == 0 { (one, other) } else { (other, one) };
            let corner = [0, 1, 2].map(|_| if random() < 0.5 { -radius } else { radius });
            let (from, side) = (center - origin, uniform_sphere([random(), random()]));
            let across = side.cross(from).normalized();
            for target in [center + across * radius, center + Vec3::new(corner[0], corner[1], corner[2]), center] {
                let direction = (target - origin).normalized();
                let distance = dot(target - origin, direction);
                all.push(Meeting { ray: Ray { origin, direction }, center, radius, distance });
            }
        }
        all
    }

    /// Counts the boxes and spheres that are wrongly rejected.
    struct Try<'a>(&'a [Meeting], f64);

    impl Work for Try<'_> {
        type Output = usize;

        #[inline(always)]
        fn run<V: Float>(self) -> usize {
            let Self(meetings, factor) = self;
            let mut wrong = 0;
            for Meeting { ray, center, radius, distance } in meetings {
                let (ray, center) = (Ray { origin: ray.origin * factor, ..*ray }, *center * factor);
                let (radius, distance) = (radius * factor, distance * factor);
                let bounds = Bounds {
                    low: [center.x - radius, center.y - radius, center.z - radius],
                    high: [center.x + radius, center.y + radius, center.z + radius],
                };
                // Every scene contains the origin.
                let scale = Scale::of(&bounds.and(&Bounds { low: [-factor; 3], high: [factor; 3] }));
                let mut all = AllCoarse::empty();
                let side_by_side = Ray::<V> { origin: Vec3::splat(ray.origin), direction: Vec3::splat(ray.direction) };
                all.fill(&side_by_side, scale);
                let coarse = all.of_lane::<V::Single>(V::LANES - 1);
                let padded = scale.padded(&bounds);
                let rows = |numbers: &[f64]| -> Vec<f32> {
                    numbers.iter().flat_map(|number| vec![*number as f32; V::Single::LANES]).collect()
                };
                let faces = [0, 1, 2].map(|axis| [padded.low[axis], padded.high[axis]]);
                let (_, met) = coarse.enter(&rows(&faces.concat()), scale.limit(distance));
                wrong += usize::from(!met.any());
                let sphere = scale.sphere(&bounds, center, radius);
                // A hit at exactly the limit must not be rejected.
                let root = first_root(ray.origin - center, ray.direction, 1.0, radius);
                wrong += usize::from(root > 0.0 && coarse.passes(&rows(&sphere), scale.limit(root)).any());
            }
            wrong
        }
    }

    #[test]
    fn boxes_and_spheres_that_are_met_are_let_in() {
        let meetings = meetings();
        for level in levels() {
            for factor in [1.0, 1e-60, 1e60] {
                let wrong = on_level(level, Precision::F64, Try(&meetings, factor));
                assert_eq!(wrong, 0, "{} {factor}", level.name());
            }
        }
    }
}
