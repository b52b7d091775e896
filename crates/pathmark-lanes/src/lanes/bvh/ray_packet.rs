//! The rays of all lanes for searches of one ray at a time, and rays in their own axes for triangle tests.

use super::coarse::{AllCoarse, Coarse, Scale};
use crate::lanes::rays::Found;
use crate::lanes::rays::Rays;
use crate::simd::{Float, MOST_LANES, Mask};
use pathmark_tracer::math::{Ray, Shear, Vec3, sheared};

/// The rays of all lanes, in memory instead of registers. Aligned to pages, like [`super::Stacks`]: a processor takes a
/// load for one of data just stored if both have the same offset in a page, so the speed of searches depended on the
/// addresses in memory.
#[repr(align(4096))]
pub(super) struct RayPacket<V: Float> {
    /// Origins, directions, and the primitives that rays start on.
    rows: [[V::One; MOST_LANES]; 7],
    pub(super) coarse: AllCoarse,
    /// Origins in the rays' own axes and [`Shear::by`]; meaningless in a scene without triangles.
    turned: [[V::One; MOST_LANES]; 6],
    /// [`Shear::axes`].
    axes: [[usize; 3]; MOST_LANES],
    /// Distances and numbers of the nearest primitives so far.
    pub(super) nearest: [V::One; MOST_LANES],
    pub(super) primitive: [V::One; MOST_LANES],
    /// The distances in sizes of the scene: boxes that begin farther away need no test.
    pub(super) limits: [f32; MOST_LANES],
}

impl<V: Float> RayPacket<V> {
    #[inline(always)]
    pub(super) fn empty() -> Self {
        let none = [V::One::default(); MOST_LANES];
        Self {
            rows: [none; 7],
            coarse: AllCoarse::empty(),
            turned: [none; 6],
            axes: [[0; 3]; MOST_LANES],
            nearest: none,
            primitive: none,
            limits: [0.0; MOST_LANES],
        }
    }

    /// Returns the lanes whose rays can be tested against boxes, as [`AllCoarse::fill`] does.
    #[inline(always)]
    pub(super) fn fill(&mut self, rays: &Rays<V>, found: &Found<V>, scale: Scale, has_triangles: bool) -> u32 {
        let Ray { origin, direction } = rays.ray;
        let vectors = [origin.x, origin.y, origin.z, direction.x, direction.y, direction.z, rays.from];
        for (row, vector) in self.rows.iter_mut().zip(&vectors) {
            vector.store(row);
        }
        found.nearest.store(&mut self.nearest);
        found.primitive.store(&mut self.primitive);
        for (limit, nearest) in self.limits.iter_mut().zip(&self.nearest).take(V::LANES) {
            *limit = scale.limit((*nearest).into());
        }
        let are_in_range = self.coarse.fill(&rays.ray, scale).bits();
        if has_triangles {
            let turned = ShearedRays::of(rays);
            let [x, y, z] = turned.axes(origin);
            for (row, vector) in self.turned.iter_mut().zip([x, y, z].iter().chain(&turned.by)) {
                vector.store(row);
            }
            let [is_x, is_y] = [turned.is_long[0].bits(), turned.is_long[1].bits()];
            for (lane, axes) in self.axes.iter_mut().enumerate().take(V::LANES) {
                *axes = AXES[(is_x >> lane & 1 | (is_y >> lane & 1) << 1) as usize];
            }
        }
        are_in_range
    }

    #[inline(always)]
    pub(super) fn of_lane(&self, lane: usize) -> Single<V> {
        let [ox, oy, oz, dx, dy, dz, from] = self.rows.each_ref().map(|row| row[lane].into());
        let (origin, direction) = (Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz));
        Single { origin, direction, from, coarse: self.coarse.of_lane(lane) }
    }

    /// Number of the primitive that a ray starts on.
    #[inline(always)]
    pub(super) fn from(&self, lane: usize) -> f64 {
        self.rows[6][lane].into()
    }

    /// A ray in its own axes, in a scene with triangles.
    #[inline(always)]
    pub(super) fn sheared(&self, lane: usize) -> ShearedRay<V::Register> {
        let [x, y, z, by_x, by_y, by_z] = self.turned.each_ref().map(|row| row[lane].into());
        let shear = Shear { axes: self.axes[lane], by: three([by_x, by_y, by_z]) };
        ShearedRay { origin: three([x, y, z]), shear }
    }
}

/// Axes of a ray whose longest component is z, x or y.
const AXES: [[usize; 3]; 3] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];

/// One ray.
pub(super) struct Single<V: Float> {
    pub(super) origin: Vec3,
    pub(super) direction: Vec3,
    /// Number of the primitive that the ray starts on, as in [`Rays`].
    pub(super) from: f64,
    pub(super) coarse: Coarse<V::Single>,
}

/// A ray in its own axes, repeated in all lanes.
pub(super) struct ShearedRay<V> {
    pub(super) origin: [V; 3],
    pub(super) shear: Shear<V>,
}

#[inline(always)]
pub(super) fn three<V: Float>([x, y, z]: [f64; 3]) -> [V; 3] {
    [V::splat(x), V::splat(y), V::splat(z)]
}

/// Rays in their own axes: [`pathmark_tracer::math::Shear`] in lanes.
pub(super) struct ShearedRays<V: Float> {
    origin: Vec3<V>,
    /// Whether the direction's longest component is x, or y.
    pub(super) is_long: [V::Mask; 2],
    pub(super) by: [V; 3],
}

impl<V: Float> ShearedRays<V> {
    #[inline(always)]
    pub(super) fn of(rays: &Rays<V>) -> Self {
        let Vec3 { x, y, z } = rays.ray.direction;
        let is_x = y.abs().lt(x.abs()) & z.abs().lt(x.abs());
        let is_y = !is_x & z.abs().lt(y.abs());
        let mut turned = Self { origin: rays.ray.origin, is_long: [is_x, is_y], by: three([0.0; 3]) };
        let [x, y, z] = turned.axes(rays.ray.direction);
        turned.by = if V::IS_DOUBLE {
            let inverse = V::splat(1.0) / z;
            [x * inverse, y * inverse, inverse]
        } else {
            in_double([x, y, z])
        };
        turned
    }

    /// The components of a vector in the ray's axes.
    #[inline(always)]
    pub(super) fn axes(&self, Vec3 { x, y, z }: Vec3<V>) -> [V; 3] {
        let [is_x, is_y] = self.is_long;
        [
            V::select(is_x, y, V::select(is_y, z, x)),
            V::select(is_x, z, V::select(is_y, x, y)),
            V::select(is_x, x, V::select(is_y, y, z)),
        ]
    }

    #[inline(always)]
    pub(super) fn corner(&self, corner: Vec3) -> [V; 3] {
        sheared(self.axes(Vec3::splat(corner) - self.origin), self.by)
    }
}

/// [`pathmark_tracer::math::Shear::by`] of directions in their own axes, rounded to single precision once, as for a single ray.
#[inline(always)]
fn in_double<V: Float>(direction: [V; 3]) -> [V; 3] {
    let mut rows = [[V::One::default(); MOST_LANES]; 3];
    for (row, vector) in rows.iter_mut().zip(direction) {
        vector.store(row);
    }
    for lane in 0..V::LANES {
        let inverse = 1.0 / rows[2][lane].into();
        let by = |row: &[V::One; MOST_LANES]| V::one(row[lane].into() * inverse);
        [rows[0][lane], rows[1][lane], rows[2][lane]] = [by(&rows[0]), by(&rows[1]), V::one(inverse)];
    }
    [V::load(&rows[0]), V::load(&rows[1]), V::load(&rows[2])]
}
