//! Wrong tests of spheres and planes, as the reports' programs have them, to show what goes wrong. A scene asks for them;
//! only the scalar kernel has them.
//!
//! ```toml
//! [faults]
//! smaller-root-only = true   # report C: a sphere is missed if its smaller root lies behind the ray's start
//! plane-limit = 1e-4         # report C: a plane is missed by rays whose cosine to its normal is smaller
//! sphere-epsilon = 0.5       # report B: a sphere is missed if its first root ahead is not farther than this
//! ```
//!
//! With a fault of spheres the ray's start is not known to lie on its sphere, so rounding decides whether the sphere
//! hides itself, as in these programs.

use super::shape::{Nearest, Plane, Primitives, Sphere};
use super::{SurfaceOrigin, Tests};
use crate::input::{positive, share};
use crate::math::{Ray, dot};
use serde::{Deserialize, Deserializer};

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Faults {
    #[serde(default)]
    smaller_root_only: bool,
    #[serde(default, deserialize_with = "some_length")]
    sphere_epsilon: Option<f64>,
    #[serde(default, deserialize_with = "share")]
    plane_limit: f64,
}

fn some_length<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    positive(deserializer).map(Some)
}

impl Faults {
    /// The distance to a sphere; zero, negative or NaN if the ray misses it. `exactly` is the right one.
    fn to_sphere(self, sphere: &Sphere, ray: &Ray, exactly: f64) -> f64 {
        if !self.smaller_root_only && self.sphere_epsilon.is_none() {
            return exactly;
        }
        let offset = ray.origin - sphere.center;
        let half = dot(offset, ray.direction);
        let root = (half * half - dot(offset, offset) + sphere.radius * sphere.radius).sqrt();
        let (smaller, larger) = (-half - root, -half + root);
        let t = if smaller < 0.0 && !self.smaller_root_only { larger } else { smaller };
        if t > self.sphere_epsilon.unwrap_or(0.0) { t } else { f64::NAN }
    }

    fn to_plane(self, plane: &Plane, ray: &Ray, exactly: f64) -> f64 {
        if dot(plane.normal, ray.direction).abs() < self.plane_limit { f64::NAN } else { exactly }
    }

    /// The first primitive along the ray nearer than `limit`, found by testing all of them.
    #[cold]
    #[inline(never)]
    pub(super) fn nearest(
        &self,
        primitives: &Primitives,
        ray: &Ray,
        from: Option<SurfaceOrigin>,
        limit: f64,
        tests: &mut Tests,
    ) -> Nearest {
        let Primitives { spheres, planes, triangles, .. } = primitives;
        let exactly = primitives.sure_distances(ray, from, f64::MANTISSA_DIGITS);
        let spheres = spheres.iter().map(|sphere| (Some(sphere), None));
        let planes = planes.iter().map(|plane| (None, Some(plane)));
        let others = triangles.iter().map(|_| (None, None));
        (0_u32..).zip(spheres.chain(planes).chain(others)).fold(Nearest::than(limit), |nearest, (primitive, kind)| {
            tests.primitives += 1;
            let t = exactly(primitive);
            let t = match kind {
                (Some(sphere), _) => self.to_sphere(sphere, ray, t),
                (_, Some(plane)) => self.to_plane(plane, ray, t),
                _ => t,
            };
            nearest.or_in_any_order(t, primitive)
        })
    }

    #[must_use]
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self { sphere_epsilon: self.sphere_epsilon.map(|distance| distance * factor), ..self }
    }
}

#[cfg(test)]
mod tests {
    use crate::math::{Ray, Vec3};
    use crate::scene::{AllEffects, Scene, SurfaceOrigin, Tests, load};

    fn distance(scene: &Scene, origin: [f64; 3], direction: [f64; 3], from: Option<SurfaceOrigin>) -> Option<f64> {
        let ray = Ray { origin: Vec3::from(origin), direction: Vec3::from(direction).normalized() };
        Some(scene.intersect::<AllEffects>(&ray, from, &mut Tests::default())?.t)
    }

    /// The dome has radius 1e4 around the origin, and the floor is y = 0.
    #[test]
    fn a_sphere_is_missed_from_inside_and_a_plane_by_grazing_rays() {
        let [right, wrong] = ["report-c-dome", "report-c-dome-faults"].map(|name| load(name).unwrap());
        let from_origin = |scene| distance(scene, [0.0; 3], [0.0, 1.0, 0.0], None);
        assert_eq!([&right, &wrong].map(from_origin), [Some(1e4), None]);
        // From 0.1 above the floor, 1.2e-4 and 0.8e-4 below the horizon: 0.1/1.2e-4 = 833 and 0.1/0.8e-4 = 1250.
        let down = |scene, slope: f64| distance(scene, [0.0, 0.1, 8.0], [1.0, -slope, 0.0], None);
        assert!([&right, &wrong].iter().all(|scene| down(scene, 1.2e-4).is_some_and(|t| (832.0..834.0).contains(&t))));
        assert!(down(&right, 0.8e-4).is_some_and(|t| (1249.0..1251.0).contains(&t)));
        assert_eq!(down(&wrong, 0.8e-4), None);
        // A sphere is seen from outside as before.
        let ahead = |scene| distance(scene, [0.0, 2.2, 8.0], [-2.1, -1.2, -8.4], None).unwrap();
        assert!((ahead(&right) - ahead(&wrong)).abs() < 1e-12 && ahead(&right) < 8.0);
    }

    /// The ball has radius 100 around (150, 100, 200); the floor is y = 0.
    #[test]
    fn near_roots_of_spheres_are_dropped_and_those_of_triangles_are_not() {
        let [half, zero] = ["cornell-mesh-ball-half", "cornell-mesh-ball-zero"].map(|name| load(name).unwrap());
        let (below, up) = ([150.0, -0.25, 200.0], [0.0, 1.0, 0.0]);
        // The floor at 0.25, and the ball at the same distance, which goes after it.
        assert_eq!(distance(&half, below, up, None), Some(0.25));
        let beside = ([150.0, 100.0, 99.75], [0.0, 0.0, 1.0]);
        assert_eq!(distance(&zero, beside.0, beside.1, None), Some(0.25));
        let beyond = distance(&half, beside.0, beside.1, None).unwrap();
        assert!(beyond > 400.0, "the back wall, not the ball's far side at 200.25: {beyond}");
        // A start that rounding put inside hides itself: the ball is primitive 0.
        let from = Some(SurfaceOrigin { primitive: 0, inside: false });
        let start = [150.0, 100.0, 100.0 + 1e-12];
        assert!(distance(&zero, start, [0.0, 0.0, -1.0], from).is_some_and(|t| t < 1e-11));
        assert!(distance(&half, start, [0.0, 0.0, -1.0], from).is_none_or(|t| t > 50.0));
    }
}
