//! A light without a size: its irradiance falls off with the square of the distance.
//!
//! ```toml
//! [[point-lights]]
//! position = [50.0, 70.0, 80.0]
//! intensity = [10000.0, 10000.0, 10000.0]   # W per steradian
//! reach = 200.0                             # optional: farther away it gives no light, as in report C
//! ```

use crate::input::{length, point, radiance};
use crate::math::{Rgb, Vec3};
use serde::{Deserialize, Deserializer};

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PointLight {
    #[serde(deserialize_with = "point")]
    pub position: Vec3,
    /// Radiant intensity, in W per steradian.
    #[serde(deserialize_with = "radiance")]
    pub intensity: Rgb,
    /// The distance beyond which it gives no light, unlike any real light; `None` if it follows the inverse square law
    /// everywhere.
    #[serde(default, deserialize_with = "reach")]
    pub reach: Option<f64>,
}

fn reach<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    length(deserializer).map(Some)
}

impl PointLight {
    /// Returns the light with every length multiplied by `factor`; its irradiance stays the same.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let reach = self.reach.map(|reach| reach * factor);
        Self { position: self.position * factor, intensity: self.intensity * (factor * factor), reach }
    }
}
