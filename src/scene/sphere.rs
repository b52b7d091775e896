//! A sphere.
//!
//! ```toml
//! shape = { sphere = { center = [27.0, 16.5, 47.0], radius = 16.5 } }
//! ```

use crate::input::{length, point};
use crate::math::{Ray, Vec3, dot, first_root};
use serde::Deserialize;

/// A sphere, in scene units.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// Its centre.
    #[serde(deserialize_with = "point")]
    pub center: Vec3,
    /// Its radius.
    #[serde(deserialize_with = "length")]
    pub radius: f64,
}

impl Sphere {
    /// Distance to the surface for a ray (of unit direction) that starts elsewhere; not above zero, or NaN, if it misses.
    #[inline(always)]
    pub fn meet(&self, ray: &Ray) -> f64 {
        first_root(ray.origin - self.center, ray.direction, 1.0, self.radius)
    }

    /// Distance to the surface for a ray that starts on it: one root is the start, the other is twice the way to the closest approach.
    /// To the outside there is none.
    #[inline(always)]
    pub fn leave(&self, ray: &Ray, inside: bool) -> f64 {
        if inside { 2.0 * dot(self.center - ray.origin, ray.direction).abs() } else { f64::NAN }
    }

    /// The outward unit normal at a point of the surface.
    #[inline(always)]
    pub fn normal(&self, point: Vec3) -> Vec3 {
        (point - self.center).normalized()
    }

    /// The same sphere with every length multiplied.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { center: self.center * factor, radius: self.radius * factor }
    }
}
