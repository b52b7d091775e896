//! Which hits of triangles may not be sure: what [`crate::scene::nearness`] and the padding of boxes say of one ray, of many.

use crate::kernel::lanes::nearest::Found;
use crate::kernel::lanes::tables::Tables;
use crate::math::{Ray, Vec3, dot};
use crate::scene::{nearness, padding};
use crate::simd::Float;

/// The lanes whose hits are to be looked at again.
///
/// In single precision only those that start near the plane of what they meet: the padding of its boxes covers the rest.
#[inline(always)]
pub(super) fn are_doubtful<V: Float>(tables: &Tables, ray: &Ray<V>, found: &Found<V>) -> V::Mask {
    let Ray { origin, direction } = *ray;
    let [x, y, z, far] = V::rows(&tables.surfaces, found.primitive);
    let is_triangle = far.lt(V::splat(0.0)) & found.nearest.lt(V::splat(f64::INFINITY));
    let reach = origin.x.abs().larger(origin.y.abs()).larger(origin.z.abs()) - far;
    let height = found.nearest * dot(Vec3 { x, y, z }, direction).abs();
    let mut doubtful = height.le(reach * V::splat(nearness(V::SIGNIFICAND)));
    if let Some([lows, highs]) = &tables.boxes {
        let slack = reach * V::splat(0.5 * padding(f64::MANTISSA_DIGITS));
        let point = ray.at(found.nearest);
        let [x, y, z, _] = V::rows(lows, found.primitive);
        let below = point.x.lt(x - slack) | point.y.lt(y - slack) | point.z.lt(z - slack);
        let [x, y, z, _] = V::rows(highs, found.primitive);
        let above = (x + slack).lt(point.x) | (y + slack).lt(point.y) | (z + slack).lt(point.z);
        doubtful = doubtful | below | above;
    }
    is_triangle & doubtful
}
