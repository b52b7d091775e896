//! smallpt's camera: a pinhole whose rays start some way in front of it, and a tent filter over 2x2 subpixels.
//!
//! ```toml
//! [camera.smallpt]
//! position = [50.0, 52.0, 295.6]
//! direction = [0.0, -0.042612, -1.0]
//! field = 0.5135     # height of the image plane at distance 1
//! advance = 140.0    # rays start this far along their direction
//! ```

use super::{Camera, Filter};
use crate::input::{direction, length, point, positive};
use crate::math::Vec3;
use serde::{Deserialize, Deserializer};

/// The camera as scene files write it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Smallpt {
    #[serde(deserialize_with = "point")]
    position: Vec3,
    #[serde(deserialize_with = "view_direction")]
    direction: Vec3,
    #[serde(deserialize_with = "length")]
    field: f64,
    #[serde(deserialize_with = "positive")]
    advance: f64,
}

impl Smallpt {
    pub(super) const EXAMPLE: &str = "[camera.smallpt]\nposition = [50.0, 52.0, 295.6]\ndirection = [0.0, -0.042612, -1.0]\nfield = 0.5135\nadvance = 140.0\n";
}

/// Image rows lie along the x axis, so a camera that looks along it would have no upward direction.
fn view_direction<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec3, D::Error> {
    let d = direction(deserializer)?;
    if d.y.abs().max(d.z.abs()) < 1e-6 {
        return Err(serde::de::Error::custom("points along the image's rows (allowed: a direction off the x axis)"));
    }
    Ok(d)
}

impl From<Smallpt> for Camera {
    fn from(Smallpt { position, direction, field, advance }: Smallpt) -> Self {
        let up = Vec3::new(0.0, 1.0, 0.0);
        Self { position, direction, up, field, advance, filter: Filter::Tent, lens: None }
    }
}
