//! Ray against plane.

use super::{Real, Vec3, dot};

/// Where a ray in that direction meets a plane with that normal, `to_plane` being the way from its origin to any point of the plane; NaN or not above
/// zero if it does not.
///
/// Along the plane the quotient is infinite or NaN, and neither is a hit; there is no other angle at which it vanishes.
#[inline(always)]
pub fn plane_root<T: Real>(to_plane: Vec3<T>, direction: Vec3<T>, normal: Vec3<T>) -> T {
    let t = dot(to_plane, normal) / dot(direction, normal);
    T::select(t.lt(T::splat(f64::INFINITY)), t, T::splat(f64::NAN))
}
