//! A sphere.
//!
//! ```toml
//! shape = { sphere = { center = [27.0, 16.5, 47.0], radius = 16.5 } }
//! ```

use super::{Bounds, Primitive};
use crate::input::{length, point};
use crate::math::{Ray, Vec3, first_root, other_root};
use serde::Deserialize;

/// A sphere, in scene units.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    #[serde(deserialize_with = "point")]
    pub center: Vec3,
    #[serde(deserialize_with = "length")]
    pub radius: f64,
}

impl Primitive for Sphere {
    type Prepared = ();

    #[inline(always)]
    fn prepare(_ray: &Ray) -> Self::Prepared {}

    #[inline(always)]
    fn meet(&self, ray: &Ray, _prepared: &()) -> f64 {
        first_root(ray.origin - self.center, ray.direction, 1.0, self.radius)
    }

    /// A ray to the outside has no other root.
    #[inline(always)]
    fn leave(&self, ray: &Ray, inside: bool) -> f64 {
        if inside { other_root(self.center - ray.origin, ray.direction) } else { f64::NAN }
    }

    #[inline(always)]
    fn normal(&self, point: Vec3) -> Vec3 {
        (point - self.center).normalized()
    }

    fn bounds(&self) -> Option<Bounds> {
        let r = Vec3::new(self.radius, self.radius, self.radius);
        Some(Bounds::of_points(&[self.center - r, self.center + r]))
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { center: self.center * factor, radius: self.radius * factor }
    }
}
