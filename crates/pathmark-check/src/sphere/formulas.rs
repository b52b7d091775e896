//! The program's implementations of ray-sphere intersection. Each case tests them all.

use crate::bare_scene::{intersect, scene_of_spheres, searches};
use crate::math::{Ray, Vec3, dot, first_root, roots};
use crate::scene::{Primitive, Sphere};

/// One instance of the formulas in `math`.
pub(super) struct Formula {
    pub(super) name: &'static str,
    /// Both roots of f, d, |d|², r; NaN for a miss.
    pub(super) roots: fn(Vec3, Vec3, f64, f64) -> (f64, f64),
    /// The first root ahead; at most 0, or NaN, if there is none.
    pub(super) first: fn(Vec3, Vec3, f64, f64) -> f64,
}

/// Number types for which the formulas are instantiated. Lanes get a line each.
pub(super) const FORMULAS: &[Formula] = &[Formula { name: "f64", roots: roots::<f64>, first: first_root::<f64> }];

impl Formula {
    /// The first hit ahead.
    pub(super) fn hit(&self, f: Vec3, d: Vec3, a: f64, r: f64) -> Option<f64> {
        Some((self.first)(f, d, a, r)).filter(|t| *t > 0.0)
    }
}

/// The first hit of a ray by each implementation: every formula and, if the ray has length 1 like all rays of paths,
/// the primitive and a scene of it with every accelerator.
pub(super) fn first_hits(origin: Vec3, d: Vec3, center: Vec3, r: f64) -> Vec<(String, Option<f64>)> {
    let (f, a) = (origin - center, dot(d, d));
    let mut hits: Vec<(String, Option<f64>)> =
        FORMULAS.iter().map(|formula| (format!("first root, {}", formula.name), formula.hit(f, d, a, r))).collect();
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
