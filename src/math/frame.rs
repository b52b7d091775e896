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
            s: Vec3::new(one + sign * n.x * n.x * a, sign * b, -(sign * n.x)),
            t: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// World to local.
    #[inline(always)]
    pub fn to_local(&self, v: Vec3<T>) -> Vec3<T> {
        Vec3::new(dot(v, self.s), dot(v, self.t), dot(v, self.n))
    }

    /// Local to world.
    #[inline(always)]
    pub fn to_world(&self, v: Vec3<T>) -> Vec3<T> {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// H01: poles, axes with signed zeros, and 1000 neighbours of z = -1, where other constructions fail.
    #[test]
    fn frames_are_orthonormal_everywhere() {
        let mut normals = vec![
            Vec3::new(0.0, 0.0, -1.0),
            Vec3::new(0.0, 0.0, 1.0),
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(-1.0, 0.0, -0.0),
            Vec3::new(0.0, 1.0, -0.0),
            Vec3::new(0.0, -1.0, 0.0),
        ];
        for k in 0..1000_u32 {
            let z = -1.0 + f64::from(k) * f64::EPSILON / 2.0;
            normals.push(Vec3::new((1.0 - z * z).max(0.0).sqrt(), 0.0, z));
            normals.push(Vec3::new(0.1 * f64::from(k) - 50.0, 13.0, -f64::from(k)).normalized());
        }
        let tolerance = 6.0 * f64::EPSILON / 2.0;
        for n in normals {
            let f = Frame::around(n);
            for (name, error) in [
                ("s.t", dot(f.s, f.t)),
                ("s.n", dot(f.s, n)),
                ("t.n", dot(f.t, n)),
                ("|s|", dot(f.s, f.s).sqrt() - 1.0),
                ("|t|", dot(f.t, f.t).sqrt() - 1.0),
            ] {
                assert!(error.abs() <= tolerance, "{name} is off by {error:e} for {n:?}");
            }
            let handed = f.s.cross(f.t) - n;
            assert!(dot(handed, handed).sqrt() <= tolerance, "left-handed at {n:?}");
        }
    }
}
