//! An infinite plane, visible from both sides. Its normal points to its outside.
//!
//! ```toml
//! shape = { plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] } }
//! ```

use super::{Bounds, Primitive};
use crate::input::{direction, point};
use crate::math::{Ray, Vec3, plane_root};
use serde::Deserialize;

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plane {
    #[serde(deserialize_with = "point")]
    pub point: Vec3,
    /// Its normal; reading normalises it.
    #[serde(deserialize_with = "direction")]
    pub normal: Vec3,
}

impl Primitive for Plane {
    type Prepared = ();

    fn prepare(_ray: &Ray) -> Self::Prepared {}

    #[inline(always)]
    fn meet(&self, ray: &Ray, _prepared: &()) -> f64 {
        plane_root(self.point - ray.origin, ray.direction, self.normal)
    }

    #[inline(always)]
    fn leave(&self, _ray: &Ray, _inside: bool) -> f64 {
        f64::NAN
    }

    #[inline(always)]
    fn normal(&self, _point: Vec3) -> Vec3 {
        self.normal
    }

    fn bounds(&self) -> Option<Bounds> {
        None
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { point: self.point * factor, ..*self }
    }
}
