//! The implementations of ray-sphere intersection: the program's, which each case tests, and smallpt's formulas, which
//! these replace: for comparison in cases and in the price list, never in a kernel.

use crate::bare_scene::{intersect, scene_of_spheres, searches};
use crate::math::{Ray, Vec3, dot, first_root};
use crate::scene::{Primitive, Sphere};

/// The first hit ahead by the formula of `math`, for f, d, |d|², r.
pub(super) fn formula_hit(f: Vec3, d: Vec3, a: f64, r: f64) -> Option<f64> {
    Some(first_root(f, d, a, r)).filter(|t| *t > 0.0)
}

/// The first hit of a ray by each implementation: the formula and, if the ray has length 1 like all rays of paths,
/// the primitive and a scene of it with every accelerator.
pub(super) fn first_hits(origin: Vec3, d: Vec3, center: Vec3, r: f64) -> Vec<(String, Option<f64>)> {
    let (f, a) = (origin - center, dot(d, d));
    let mut hits = vec![("first root, f64".to_string(), formula_hit(f, d, a, r))];
    if (a - 1.0).abs() <= 4.0 * f64::EPSILON {
        let (sphere, ray) = (Sphere { center, radius: r }, Ray { origin, direction: d });
        hits.push(("primitive".to_string(), Some(sphere.meet(&ray, &())).filter(|t| *t > 0.0)));
        let scene = scene_of_spheres(vec![sphere]);
        hits.extend(searches(&scene).map(|(name, scene)| {
            (format!("scene, accelerator {name}"), intersect(&scene, &ray, None).map(|hit| hit.t))
        }));
    }
    hits
}

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
