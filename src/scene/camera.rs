//! smallpt's camera: a pinhole whose rays start some way in front of it, and a tent filter over 2x2 subpixels.
//!
//! ```toml
//! [camera.smallpt]
//! position = [50.0, 52.0, 295.6]
//! direction = [0.0, -0.042612, -1.0]
//! field = 0.5135     # height of the image plane at distance 1
//! advance = 140.0    # rays start this far along their direction
//! ```

use crate::input::{direction, length, point, positive};
use crate::math::{Ray, Vec3};
use crate::sampling::tent;
use serde::Deserialize;

/// A camera of the smallpt family. The pixel filter belongs to it: sample k of a pixel takes subpixel k mod 4.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// The pinhole.
    #[serde(deserialize_with = "point")]
    pub position: Vec3,
    /// The middle of the view; of length 1 once it is read.
    #[serde(deserialize_with = "view_direction")]
    pub direction: Vec3,
    /// Height of the image plane at distance 1.
    #[serde(deserialize_with = "length")]
    pub field: f64,
    /// How far along its direction a ray starts, so that it can start inside a closed box.
    #[serde(deserialize_with = "positive")]
    pub advance: f64,
}

/// Rows lie along the x axis, so a camera that looks along it would have no upward direction.
fn view_direction<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Vec3, D::Error> {
    let d = direction(deserializer)?;
    if d.y.abs().max(d.z.abs()) < 1e-6 {
        return Err(serde::de::Error::custom("looks along the image's own rows (allowed: a direction off the x axis)"));
    }
    Ok(d)
}

/// A camera set up for an image size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    camera: Camera,
    right: Vec3,
    up: Vec3,
    width: f64,
    height: f64,
    rows: u32,
}

/// Subpixels in a pixel: 2 by 2.
pub const SUBPIXELS: u32 = 4;

impl Camera {
    /// Sets up the image plane for `width` x `height` pixels.
    pub fn view(&self, width: u32, height: u32) -> View {
        let (w, h) = (f64::from(width), f64::from(height));
        let right = Vec3::new(w * self.field / h, 0.0, 0.0);
        let up = right.cross(self.direction).normalized() * self.field;
        View { camera: *self, right, up, width: w, height: h, rows: height }
    }

    /// The same camera with every length multiplied.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { position: self.position * factor, advance: self.advance * factor, ..*self }
    }
}

impl View {
    /// The ray of sample `sample` through pixel (`x`, `y`), row 0 at the top.
    ///
    /// The direction is normalised before the ray is advanced. g++ happens to evaluate smallpt's expression in that order; the other
    /// order starts rays above the ceiling and lights the top rows.
    #[inline(always)]
    pub fn ray(&self, x: u32, y: u32, sample: u32, u: [f64; 2]) -> Ray {
        let subpixel = sample % SUBPIXELS;
        let (sx, sy) = (f64::from(subpixel % 2), f64::from(subpixel / 2));
        let across = ((sx + 0.5 + tent(u[0])) / 2.0 + f64::from(x)) / self.width - 0.5;
        let upward = ((sy + 0.5 + tent(u[1])) / 2.0 + f64::from(self.rows - 1 - y)) / self.height - 0.5;
        let direction = (self.right * across + self.up * upward + self.camera.direction).normalized();
        Ray { origin: self.camera.position + direction * self.camera.advance, direction }
    }
}
