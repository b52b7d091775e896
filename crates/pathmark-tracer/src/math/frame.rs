//! An orthonormal frame around a normal.

use super::{Real, Vec3, dot};

/// Two tangents and a normal; local z is the normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame<T = f64> {
    /// First tangent, local x.
    pub s: Vec3<T>,
    /// Second tangent, local y.
    pub t: Vec3<T>,
    /// The normal, local z.
    pub n: Vec3<T>,
}

impl<T: Real> Frame<T> {
    /// The frame around a unit normal, without a branch and without a pole: Duff et al., "Building an Orthonormal Basis, Revisited",
    /// JCGT 6(1), 2017. Frisvad's earlier form loses orthogonality near z = -1 (0.9 in single precision).
    #[inline(always)]
    pub fn around(n: Vec3<T>) -> Self {
        let one = T::splat(1.0);
        let sign = one.copysign(n.z);
        let a = -one / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: Vec3::new((sign * n.x * n.x).times_plus(a, one), sign * b, -(sign * n.x)),
            t: Vec3::new(b, (n.y * n.y).times_plus(a, sign), -n.y),
            n,
        }
    }

    #[inline(always)]
    pub fn to_local(&self, v: Vec3<T>) -> Vec3<T> {
        Vec3::new(dot(v, self.s), dot(v, self.t), dot(v, self.n))
    }

    #[inline(always)]
    pub fn to_world(&self, v: Vec3<T>) -> Vec3<T> {
        self.n.times_plus(v.z, self.t.times_plus(v.y, self.s * v.x))
    }
}
