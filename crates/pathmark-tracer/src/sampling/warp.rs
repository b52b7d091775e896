//! Warps of the unit square to the distributions that paths need, and the densities of those distributions.

use crate::math::{Real, Vec3, sin_cos_turns};
use std::f64::consts::PI;

/// A direction around +z with density cos θ/π per steradian (Malley's method: the uniform disk lifted to the hemisphere).
#[inline(always)]
pub fn cosine_hemisphere<T: Real>([u, v]: [T; 2]) -> Vec3<T> {
    let (sin, cos) = sin_cos_turns(u);
    let r = v.sqrt();
    Vec3::new(cos * r, sin * r, (T::splat(1.0) - v).sqrt())
}

/// A number in [-1, 1) with the tent density 1 - |x|: smallpt's pixel filter.
#[inline(always)]
pub fn tent<T: Real>(u: T) -> T {
    let (one, two) = (T::splat(1.0), T::splat(2.0));
    let r = u * two;
    T::select(r.lt(one), r.sqrt() - one, one - (two - r).sqrt())
}

/// A point of the unit disk with density 1/π; neighbours stay neighbours (Shirley and Chiu, "A Low Distortion Map
/// Between Disk and Square", 1997).
#[inline(always)]
pub fn concentric_disk([u, v]: [f64; 2]) -> [f64; 2] {
    let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if x == 0.0 && y == 0.0 {
        return [0.0, 0.0];
    }
    // The angle in turns: at most an eighth of a turn from the nearer axis.
    let (r, turns) = if x.abs() > y.abs() { (x, 0.125 * (y / x)) } else { (y, 0.25 - 0.125 * (x / y)) };
    let (sin, cos) = sin_cos_turns(turns);
    [r * cos, r * sin]
}

/// The density per steradian of uniformly distributed directions.
pub const UNIFORM_SPHERE_DENSITY: f64 = 0.25 / PI;

/// A direction with the density [`UNIFORM_SPHERE_DENSITY`].
#[inline(always)]
pub fn uniform_sphere<T: Real>([u, v]: [T; 2]) -> Vec3<T> {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let z = one - T::splat(2.0) * v;
    let square = one - z * z;
    let r = T::select(square.lt(zero), zero, square).sqrt();
    let (sin, cos) = sin_cos_turns(u);
    Vec3::new(r * cos, r * sin, z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::dot;

    const CORNERS: [f64; 5] = [0.0, f64::EPSILON / 2.0, 0.5, 1.0 - f64::EPSILON / 2.0, 1.0];

    /// H03, also at u = 1, which the samplers never return.
    #[test]
    fn cosine_warp_is_finite_at_the_corners() {
        for u in CORNERS {
            for v in CORNERS {
                let d = cosine_hemisphere([u, v]);
                assert!(d.z >= 0.0 && (dot(d, d).sqrt() - 1.0).abs() <= 4.0 * f64::EPSILON, "({u}, {v}): {d:?}");
            }
        }
    }

    /// Under the density cos θ/π the mean of cos θ is 2/3 and of cos² θ is 1/2; the midpoint rule finds both within 1e-5.
    #[test]
    fn cosine_warp_has_the_moments_of_its_density() {
        let n = 1000;
        let (mut first, mut second) = (0.0, 0.0);
        for k in 0..n {
            let z = cosine_hemisphere([0.3, (f64::from(k) + 0.5) / f64::from(n)]).z;
            first += z / f64::from(n);
            second += z * z / f64::from(n);
        }
        assert!((first - 2.0 / 3.0).abs() < 1e-5 && (second - 0.5).abs() < 1e-12, "{first} {second}");
    }

    /// The mean of `of` over the midpoints of a grid of equal cells on the unit square.
    fn mean(of: impl Fn([f64; 2]) -> f64) -> f64 {
        let n = 512;
        let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
        (0..n * n).map(|k| of([at(k % n), at(k / n)])).sum::<f64>() / f64::from(n * n)
    }

    /// As in H03: corners and middle stay on the disk, and the corners of the square are mapped to its diagonals.
    #[test]
    fn disk_warp_is_finite_at_the_corners() {
        for u in CORNERS {
            for v in CORNERS {
                let [x, y] = concentric_disk([u, v]);
                assert!(x * x + y * y <= 1.0 + 4.0 * f64::EPSILON, "({u}, {v}): {x} {y}");
            }
        }
        assert_eq!(concentric_disk([0.5, 0.5]), [0.0, 0.0]);
        let diagonal = 0.5f64.sqrt();
        for (corner, [x, y]) in [
            ([0.0, 0.0], [-diagonal, -diagonal]),
            ([1.0, 0.0], [diagonal, -diagonal]),
            ([0.0, 1.0], [-diagonal, diagonal]),
            ([1.0, 1.0], [diagonal, diagonal]),
            ([1.0, 0.5], [1.0, 0.0]),
            ([0.5, 0.0], [0.0, -1.0]),
        ] {
            let [a, b] = concentric_disk(corner);
            assert!((a - x).abs() < 1e-15 && (b - y).abs() < 1e-15, "{corner:?}: {a} {b}");
        }
    }

    /// Under the density 1/π the mean of x² is 1/4, of x² y² 1/24, of r⁴ 1/3, and odd moments vanish.
    #[test]
    fn disk_warp_has_the_moments_of_its_density() {
        let found = |of: fn(f64, f64) -> f64| mean(|u| concentric_disk(u).into_iter().reduce(of).unwrap_or_default());
        for (name, found, expected) in [
            ("x", found(|x, _| x), 0.0),
            ("xy", found(|x, y| x * y), 0.0),
            ("x2", found(|x, _| x * x), 0.25),
            ("y2", found(|_, y| y * y), 0.25),
            ("x2y2", found(|x, y| x * x * y * y), 1.0 / 24.0),
            ("r4", found(|x, y| (x * x + y * y) * (x * x + y * y)), 1.0 / 3.0),
        ] {
            assert!((found - expected).abs() < 1e-5, "{name}: {found} instead of {expected}");
        }
    }

    /// H05: unit length at the corners, as in H03. The means of z and xy vanish; those of x², y² and z² are 1/3, of z⁴
    /// 1/5.
    #[test]
    fn sphere_warp() {
        for u in CORNERS {
            for v in CORNERS {
                let d = uniform_sphere([u, v]);
                assert!((dot(d, d).sqrt() - 1.0).abs() <= 4.0 * f64::EPSILON, "({u}, {v}): {d:?}");
            }
        }
        let found = |of: fn(Vec3) -> f64| mean(|u| of(uniform_sphere(u)));
        for (name, found, expected) in [
            ("z", found(|d| d.z), 0.0),
            ("xy", found(|d| d.x * d.y), 0.0),
            ("x2", found(|d| d.x * d.x), 1.0 / 3.0),
            ("y2", found(|d| d.y * d.y), 1.0 / 3.0),
            ("z2", found(|d| d.z * d.z), 1.0 / 3.0),
            ("z4", found(|d| d.z * d.z * d.z * d.z), 0.2),
        ] {
            assert!((found - expected).abs() < 1e-5, "{name}: {found} instead of {expected}");
        }
    }

    /// H04: inside [-1, 1], with the tent's variance 1/6.
    #[test]
    fn tent_filter() {
        for u in CORNERS {
            assert!((-1.0..=1.0).contains(&tent(u)), "u = {u}");
        }
        let n = 100_000;
        let variance: f64 =
            (0..n).map(|k| tent((f64::from(k) + 0.5) / f64::from(n))).map(|x| x * x).sum::<f64>() / f64::from(n);
        assert!((variance - 1.0 / 6.0).abs() < 1e-6, "{variance}");
    }
}
