//! Ray against plane.

use super::{Real, Vec3, dot};

/// Distance at which a ray in that direction meets a plane with that normal; NaN or not above zero if it does not.
/// `to_plane` leads from the ray's origin to any point of the plane.
///
/// Along the plane the quotient is infinite or NaN, and neither is a hit. There is no threshold for other angles.
#[inline(always)]
pub fn plane_root<T: Real>(to_plane: Vec3<T>, direction: Vec3<T>, normal: Vec3<T>) -> T {
    let t = dot(to_plane, normal) / dot(direction, normal);
    T::select(t.lt(T::splat(f64::INFINITY)), t, T::splat(f64::NAN))
}
