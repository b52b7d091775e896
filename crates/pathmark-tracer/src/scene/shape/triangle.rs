//! A triangle, visible from both sides; its outside is the side from which its corners run counterclockwise.
//!
//! ```toml
//! shape = { triangle = { corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] } }
//! ```

use super::{Bounds, Primitive};
use crate::input::{array, point};
use crate::math::{Ray, Shear, Vec3, dot, sheared, triangle_root};
use serde::{Deserialize, Deserializer};

/// A triangle, in scene units.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Triangle {
    #[serde(deserialize_with = "corners")]
    pub corners: [Vec3; 3],
}

/// Reads three corners that span an area.
fn corners<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[Vec3; 3], D::Error> {
    let corners = points(deserializer)?;
    if (Triangle { corners }).is_degenerate() {
        return Err(serde::de::Error::custom("the corners lie on a line (allowed: a triangle with an area)"));
    }
    Ok(corners)
}

/// Reads `N` points.
pub(super) fn points<'de, D: Deserializer<'de>, const N: usize>(deserializer: D) -> Result<[Vec3; N], D::Error> {
    array::<Point, D, N>(deserializer).map(|points| points.map(|Point(point)| point))
}

#[derive(Deserialize)]
#[serde(transparent)]
struct Point(#[serde(deserialize_with = "point")] Vec3);

impl Triangle {
    /// Whether its corners lie on a line, or so nearly that it has no normal.
    pub fn is_degenerate(&self) -> bool {
        let normal = self.normal(self.corners[0]);
        !(normal.x + normal.y + normal.z).is_finite()
    }
}

impl Primitive for Triangle {
    type Prepared = Shear;

    #[inline(always)]
    fn prepare(ray: &Ray) -> Shear {
        Shear::of(ray.direction)
    }

    #[inline(always)]
    fn meet(&self, ray: &Ray, shear: &Shear) -> f64 {
        // Written out, because `map` over an array takes three times as long.
        let [a, b, c] = self.corners;
        triangle_root(
            sheared(shear.turned(a - ray.origin), shear.by),
            sheared(shear.turned(b - ray.origin), shear.by),
            sheared(shear.turned(c - ray.origin), shear.by),
        )
    }

    #[inline(always)]
    fn leave(&self, _ray: &Ray, _inside: bool) -> f64 {
        f64::NAN
    }

    /// Scales the edges by their longest component, so that tiny and huge triangles neither under- nor overflow.
    #[inline(always)]
    fn normal(&self, _point: Vec3) -> Vec3 {
        let [a, b, c] = self.corners;
        let (e, f) = (b - a, c - a);
        let cross = (e * (1.0 / e.largest())).cross(f * (1.0 / f.largest()));
        debug_assert!(!dot(cross, cross).is_infinite());
        cross.normalized()
    }

    fn bounds(&self) -> Option<Bounds> {
        Some(Bounds::of_points(&self.corners))
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { corners: self.corners.map(|corner| corner * factor) }
    }
}
