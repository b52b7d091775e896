//! Ray against sphere.
//!
//! The discriminant is computed from the ray's closest approach (Haines et al., "Precision Improvements for Ray/Sphere
//! Intersection", Ray Tracing Gems, 2019, ch. 7), which keeps the digits of small spheres far away. The roots come from
//! q and c/q, which keeps the digits of the small root of a huge sphere. smallpt's own b² - f·f + r² loses both.
//!
//! `f` is the ray's origin relative to the centre, `d` its direction, `a` = |d|², `r` the radius.
//! The quadratic is a t² - 2 b t + c = 0. Errors of the roots are bounded by 8u(|t| + |f| + (r² + 2l|f|)/2s + (|f|² +
//! r²)/(|b| + s)), where l is the line's distance from the centre, s² = r² - l² and u = 2^-53.

use super::{Real, Vec3, dot};

/// b, and the discriminant divided by a.
#[inline(always)]
fn discriminant<T: Real>(f: Vec3<T>, d: Vec3<T>, a: T, r: T) -> (T, T) {
    let b = -dot(f, d);
    let closest = d.times_plus(b / a, f);
    (b, r * r - dot(closest, closest))
}

/// c and q: q is the root of larger magnitude times a, computed without cancellation. q is NaN if the line misses.
#[inline(always)]
fn quadratic<T: Real>(f: Vec3<T>, d: Vec3<T>, a: T, r: T) -> (T, T) {
    let (b, discriminant) = discriminant(f, d, a, r);
    let q = b + (a * discriminant).sqrt().copysign(b);
    (dot(f, f) - r * r, q)
}

/// Whether the whole line meets the sphere; otherwise there are no roots.
#[inline(always)]
pub fn line_meets<T: Real>(f: Vec3<T>, d: Vec3<T>, a: T, r: T) -> T::Mask {
    T::splat(0.0).le(discriminant(f, d, a, r).1)
}

/// Both intersections of the whole line with the sphere, nearer first, in lengths of `d`; NaN if there are none.
#[inline(always)]
pub fn roots<T: Real>(f: Vec3<T>, d: Vec3<T>, a: T, r: T) -> (T, T) {
    let (c, q) = quadratic(f, d, a, r);
    let (by_q, by_c) = (q / a, c / q);
    let forward = T::splat(0.0).lt(q);
    (T::select(forward, by_c, by_q), T::select(forward, by_q, by_c))
}

/// The first intersection at t > 0 of a ray with the sphere, in lengths of `d`; zero, negative or NaN if there is none.
///
/// A ray that starts exactly on the sphere does not meet its start. There is no branch, because most rays miss some of
/// the spheres and hit others in an order that no processor can predict.
#[inline(always)]
pub fn first_root<T: Real>(f: Vec3<T>, d: Vec3<T>, a: T, r: T) -> T {
    let (c, q) = quadratic(f, d, a, r);
    let zero = T::splat(0.0);
    // From inside (c <= 0) and forward (q > 0) the first root ahead is the far one, q/a; in every other case with a hit
    // it is c/q.
    T::select(zero.lt(q) & c.le(zero), q / a, c / q)
}

/// Distance at which a ray that starts on the sphere and goes inside meets it again. `d` must have length 1. One root
/// is the start; the other is twice the distance to the closest approach.
#[inline(always)]
pub fn other_root<T: Real>(f: Vec3<T>, d: Vec3<T>) -> T {
    T::splat(2.0) * dot(f, d).abs()
}

/// A sphere in curvature form: k |x|² + 2 n·x + c = 0, where k is the inverse of the radius, n = -k centre and c = k
/// (|centre|² - r²). No values of the radius's size cancel. So a wall that is a sphere of radius 1e5 does not shake in
/// single precision, as long as the scene is near the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereByCurvature<T = f64> {
    /// -k times the centre.
    pub normal: Vec3<T>,
    /// k, the inverse of the radius.
    pub curvature: T,
    /// k (|centre|² - r²).
    pub offset: T,
}

impl SphereByCurvature {
    /// The sphere with that centre and radius.
    pub fn of(center: Vec3, radius: f64) -> Self {
        let curvature = 1.0 / radius;
        let distance = dot(center, center).sqrt();
        Self { normal: center * -curvature, curvature, offset: (distance - radius) * ((distance + radius) * curvature) }
    }
}

/// The outward normal at a point of a [`SphereByCurvature`] sphere, from its normal and curvature. Its length is 1 up to rounding.
/// With curvature 0 it is the plane's normal.
#[inline(always)]
pub fn curved_normal<T: Real>(normal: Vec3<T>, curvature: T, point: Vec3<T>) -> Vec3<T> {
    point.times_plus(curvature, normal)
}

/// b and c of the quadratic k t² + 2 b t + c = 0 of a ray and a [`SphereByCurvature`] sphere, for a direction of length 1. `square` is |o|² of the ray's origin o,
/// `along` o·d.
#[inline(always)]
pub fn curved_quadratic<T: Real>(sphere: &SphereByCurvature<T>, o: Vec3<T>, d: Vec3<T>, square: T, along: T) -> (T, T) {
    let SphereByCurvature { normal, curvature, offset } = *sphere;
    let twice = T::splat(2.0);
    let c = twice.times_plus(dot(normal, o), curvature.times_plus(square, offset));
    (curvature.times_plus(along, dot(normal, d)), c)
}

/// [`first_root`] of a [`SphereByCurvature`] sphere by its [`curved_quadratic`], whose leading coefficient is the curvature.
#[inline(always)]
pub fn first_root_curved<T: Real>(k: T, b: T, c: T) -> T {
    let q = b + b.times_plus(b, -(k * c)).sqrt().copysign(b);
    let zero = T::splat(0.0);
    // From inside and away from the nearby surface: the far side, -q/k; in every other case with a hit it is -c/q.
    let far = q.lt(zero) & c.le(zero);
    -(T::select(far, q, c) / T::select(far, k, q))
}

/// The root at which a ray leaves the sphere for good, ahead or behind, from the same numbers; NaN if the line misses.
#[inline(always)]
pub fn last_root_curved<T: Real>(k: T, b: T, c: T) -> T {
    let q = b + b.times_plus(b, -(k * c)).sqrt().copysign(b);
    let far = q.lt(T::splat(0.0));
    -(T::select(far, q, c) / T::select(far, k, q))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Origins and directions in and around a scene of a hundred units.
    fn rays() -> impl Iterator<Item = (Vec3, Vec3)> {
        (0..2000_u32).map(|k| {
            let at = |step: u32| f64::from(k.wrapping_mul(step) % 1009) / 1009.0;
            let origin = Vec3::new(100.0 * at(37), 90.0 * at(101), 170.0 * at(211));
            let (sin, cos) = crate::math::sin_cos_turns(at(331));
            let z = 2.0 * at(503) - 1.0;
            let r = (1.0 - z * z).sqrt();
            (origin, Vec3::new(r * cos, r * sin, z))
        })
    }

    fn curved_root<T: Real>(center: Vec3, radius: f64, origin: Vec3, direction: Vec3) -> T {
        curved_root_by(first_root_curved, center, radius, origin, direction)
    }

    fn curved_root_by<T: Real>(root: fn(T, T, T) -> T, center: Vec3, radius: f64, origin: Vec3, direction: Vec3) -> T {
        let SphereByCurvature { normal, curvature, offset } = SphereByCurvature::of(center, radius);
        let sphere =
            SphereByCurvature { normal: Vec3::splat(normal), curvature: T::splat(curvature), offset: T::splat(offset) };
        let (o, d) = (Vec3::splat(origin), Vec3::splat(direction));
        let (b, c) = curved_quadratic(&sphere, o, d, dot(o, o), dot(o, d));
        root(sphere.curvature, b, c)
    }

    /// A sphere by curvature is met where a sphere by centre and radius is met: in double precision from inside, from
    /// outside, near and far; in single precision to a thousandth of a unit, except at grazing angles.
    #[test]
    fn first_root_curved_is_the_first_root() {
        let mut met = [0, 0];
        for (center, radius) in [
            (Vec3::new(1e5 + 1.0, 40.8, 81.6), 1e5),
            (Vec3::new(50.0, -1e5 + 81.6, 81.6), 1e5),
            (Vec3::new(50.0, 681.33, 81.6), 600.0),
            (Vec3::new(50.0, 40.0, 80.0), 30.0),
        ] {
            for (origin, direction) in rays() {
                let f = origin - center;
                let expected = first_root(f, direction, 1.0, radius);
                let found: f64 = curved_root(center, radius, origin, direction);
                // If the line is nearly tangent, both have few correct digits.
                let closest = f + direction * -dot(f, direction);
                let cos = (1.0 - dot(closest, closest) / (radius * radius)).max(0.0).sqrt();
                if cos < 1e-3 {
                    continue;
                }
                let is_met = expected > 0.0;
                assert_eq!(found > 0.0, is_met, "{center:?} {origin:?} {direction:?}: {found}, {expected}");
                let last: f64 = curved_root_by(last_root_curved, center, radius, origin, direction);
                let (_, far) = roots(f, direction, 1.0, radius);
                assert!((last - far).abs() < 1e-6 / cos, "{center:?} {origin:?} {direction:?}: {last}, {far}");
                if is_met {
                    let bound = 1e-6 / cos;
                    assert!(
                        (found - expected).abs() < bound,
                        "{center:?} {origin:?} {direction:?}: {found}, {expected}"
                    );
                    met[0] += 1;
                }
                let single: f32 = curved_root(center, radius, origin, direction);
                if is_met && expected < 1000.0 && cos > 0.1 && radius > 100.0 {
                    assert!((f64::from(single) - expected).abs() < 1e-3, "{center:?}: {single}, {expected}");
                    met[1] += 1;
                }
            }
        }
        assert!(met[0] > 4000 && met[1] > 1000, "{met:?}");
    }
}
