//! The formulas that `math` replaces, for comparison in cases and in the price list, never in a kernel.

use crate::math::{Vec3, dot};

/// smallpt's epsilon: a nearer root counts as the starting point of the ray.
pub(crate) const SMALLPT_EPSILON: f64 = 1e-4;

/// The roots in smallpt's form (Beason, 2008), `b -+ sqrt(b² - f·f + r²)` with `b = -f·d`, for `d` of length 1. NaN
/// for a miss.
#[inline(always)]
pub(crate) fn smallpt_roots(f: Vec3, d: Vec3, r: f64) -> (f64, f64) {
    let b = -dot(f, d);
    let root = (b * b - dot(f, f) + r * r).sqrt();
    (b - root, b + root)
}

/// The first root beyond `epsilon`; 0 if there is none, as in smallpt. smallpt's epsilon is [`SMALLPT_EPSILON`].
#[inline(always)]
pub(crate) fn smallpt_first_root(f: Vec3, d: Vec3, r: f64, epsilon: f64) -> f64 {
    let (near, far) = smallpt_roots(f, d, r);
    if near > epsilon {
        near
    } else if far > epsilon {
        far
    } else {
        0.0
    }
}
