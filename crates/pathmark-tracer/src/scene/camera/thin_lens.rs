//! A thin lens: objects at its focus distance are sharp, all others are not (Potmesil and Chakravarty, "A Lens and
//! Aperture Camera Model for Synthetic Image Generation", 1981).
//!
//! ```toml
//! [camera.thin-lens]
//! position = [50.0, 48.0, 165.0]
//! look-at = [50.0, 40.0, 60.0]
//! up = [0.0, 1.0, 0.0]           # optional
//! field-of-view = 50.0           # vertical, in degrees
//! radius = 4.0                   # of the lens
//! focus = 90.0                   # distance of the plane that is sharp
//! ```

use super::pinhole::{looking_at, upwards};
use super::{Camera, Lens};
use crate::input::{direction, field_of_view, length, point};
use crate::math::Vec3;
use serde::{Deserialize, Deserializer};

/// The camera as scene files write it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ThinLensText {
    #[serde(deserialize_with = "point")]
    position: Vec3,
    #[serde(deserialize_with = "point")]
    look_at: Vec3,
    #[serde(default = "upwards", deserialize_with = "direction")]
    up: Vec3,
    #[serde(deserialize_with = "field_of_view")]
    field_of_view: f64,
    #[serde(deserialize_with = "length")]
    radius: f64,
    #[serde(deserialize_with = "length")]
    focus: f64,
}

/// The camera, after its directions have been checked against each other.
pub(in crate::scene) struct ThinLens(Camera);

impl ThinLens {
    pub(super) const EXAMPLE: &str = "[camera.thin-lens]\nposition = [50.0, 48.0, 165.0]\nlook-at = [50.0, 40.0, 60.0]\nfield-of-view = 50.0\nradius = 4.0\nfocus = 90.0\n";
}

impl<'de> Deserialize<'de> for ThinLens {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = ThinLensText::deserialize(deserializer)?;
        let camera = looking_at(text.position, text.look_at, text.up, text.field_of_view);
        let lens = Some(Lens { radius: text.radius, focus: text.focus });
        camera.map(|camera| Self(Camera { lens, ..camera })).map_err(serde::de::Error::custom)
    }
}

impl From<ThinLens> for Camera {
    fn from(ThinLens(camera): ThinLens) -> Self {
        camera
    }
}
