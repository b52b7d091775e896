//! A triangle, seen from both sides; its outside is where its corners run counterclockwise.
//!
//! ```toml
//! shape = { triangle = { corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] } }
//! ```
//!
//! Watertight after Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013: corners are sheared to where the ray
//! is the z axis, and the signs of three edge functions decide. Two triangles that share an edge compute the same product with opposite
//! signs, so no ray passes between them; a ray through the edge itself meets both. Their second look in double precision has no place
//! here, where all is in double precision.

use super::{Bounds, Primitive};
use crate::input::{coordinate_limit, out_of_range};
use crate::math::{Ray, Vec3, dot};
use serde::{Deserialize, Deserializer};

/// A triangle, in scene units.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Triangle {
    /// Its corners.
    #[serde(deserialize_with = "corners")]
    pub corners: [Vec3; 3],
}

/// Three corners that span an area.
fn corners<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[Vec3; 3], D::Error> {
    let corners = points(deserializer)?;
    if (Triangle { corners }).is_degenerate() {
        return Err(serde::de::Error::custom("the corners lie on a line (allowed: a triangle with an area)"));
    }
    Ok(corners)
}

/// So many points.
pub(super) fn points<'de, D: Deserializer<'de>, const N: usize>(deserializer: D) -> Result<[Vec3; N], D::Error>
where
    [[f64; 3]; N]: Deserialize<'de>,
{
    let points = <[[f64; 3]; N]>::deserialize(deserializer)?;
    match points.iter().flatten().find(|x| !coordinate_limit(**x)) {
        None => Ok(points.map(Vec3::from)),
        Some(x) => Err(out_of_range(*x, "-1e100 to 1e100 in each coordinate")),
    }
}

/// The ray's own axes: z is the direction's longest component, and the shear takes the direction there.
#[derive(Clone, Copy)]
pub struct Sheared {
    axes: [usize; 3],
    shear: [f64; 3],
}

#[inline(always)]
fn component(v: Vec3, axis: usize) -> f64 {
    match axis {
        0 => v.x,
        1 => v.y,
        _ => v.z,
    }
}

impl Triangle {
    /// Whether its corners lie on a line, or so nearly that it has no normal.
    pub fn is_degenerate(&self) -> bool {
        let normal = self.normal(self.corners[0]);
        !(normal.x + normal.y + normal.z).is_finite()
    }

    /// Corner `k` as the sheared ray sees it; the same bits in whichever triangle it is a corner.
    #[inline(always)]
    fn sheared(&self, k: usize, ray: &Ray, Sheared { axes: [x, y, z], shear: [sx, sy, sz] }: &Sheared) -> [f64; 3] {
        let corner = self.corners[k] - ray.origin;
        let depth = component(corner, *z);
        [component(corner, *x) - sx * depth, component(corner, *y) - sy * depth, sz * depth]
    }
}

impl Primitive for Triangle {
    type Prepared = Sheared;

    #[inline(always)]
    fn prepare(ray: &Ray) -> Sheared {
        let d = ray.direction;
        let (x, y, z) = (d.x.abs(), d.y.abs(), d.z.abs());
        let axes = if x > y && x > z {
            [1, 2, 0]
        } else if y > z {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        };
        let inverse = 1.0 / component(d, axes[2]);
        let shear = [component(d, axes[0]) * inverse, component(d, axes[1]) * inverse, inverse];
        Sheared { axes, shear }
    }

    #[inline(always)]
    fn meet(&self, ray: &Ray, sheared: &Sheared) -> f64 {
        let (a, b, c) = (self.sheared(0, ray, sheared), self.sheared(1, ray, sheared), self.sheared(2, ray, sheared));
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        let outside = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
        let determinant = u + v + w;
        // Edge on, the determinant is zero and the quotient infinite or NaN.
        let t = (u * a[2] + v * b[2] + w * c[2]) / determinant;
        if outside || determinant == 0.0 { f64::NAN } else { t }
    }

    #[inline(always)]
    fn leave(&self, _ray: &Ray, _inside: bool) -> f64 {
        f64::NAN
    }

    /// From edges scaled by their longest component, so that neither tiny nor huge triangles under- or overflow.
    #[inline(always)]
    fn normal(&self, _point: Vec3) -> Vec3 {
        let [a, b, c] = self.corners;
        let (e, f) = (b - a, c - a);
        let largest = |v: Vec3| v.x.abs().max(v.y.abs()).max(v.z.abs());
        let cross = (e * (1.0 / largest(e))).cross(f * (1.0 / largest(f)));
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
