//! A pinhole camera.
//!
//! ```toml
//! [camera.pinhole]
//! position = [278.0, 273.0, -800.0]
//! look-at = [278.0, 273.0, 0.0]
//! up = [0.0, 1.0, 0.0]           # optional
//! field-of-view = 39.3           # vertical, in degrees
//! ```

use super::{Camera, Filter};
use crate::input::{direction, field_of_view, point};
use crate::math::{Vec3, dot};
use serde::{Deserialize, Deserializer};

/// The camera as scene files write it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct PinholeText {
    #[serde(deserialize_with = "point")]
    position: Vec3,
    #[serde(deserialize_with = "point")]
    look_at: Vec3,
    #[serde(default = "upwards", deserialize_with = "direction")]
    up: Vec3,
    #[serde(deserialize_with = "field_of_view")]
    field_of_view: f64,
}

/// The camera, after its directions have been checked against each other.
pub(in crate::scene) struct Pinhole(Camera);

impl Pinhole {
    pub(super) const EXAMPLE: &str =
        "[camera.pinhole]\nposition = [50.0, 52.0, 295.6]\nlook-at = [50.0, 40.0, 60.0]\nfield-of-view = 39.3\n";
}

pub(super) fn upwards() -> Vec3 {
    Vec3::new(0.0, 1.0, 0.0)
}

/// Returns a camera at `position` that looks at `target`; `field` is the height of the image plane at distance 1.
pub(super) fn looking_at(position: Vec3, target: Vec3, up: Vec3, field: f64) -> Result<Camera, &'static str> {
    let towards = target - position;
    let largest = towards.largest();
    if largest < 1e-100 {
        return Err("the camera looks at its own position (allowed: another point)");
    }
    let direction = (towards * (1.0 / largest)).normalized();
    let side = direction.cross(up);
    if dot(side, side) < 1e-12 {
        return Err("the camera looks along its upward direction (allowed: another `up`)");
    }
    Ok(Camera { position, direction, up, field, advance: 0.0, filter: Filter::Box, lens: None })
}

impl<'de> Deserialize<'de> for Pinhole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let PinholeText { position, look_at, up, field_of_view } = PinholeText::deserialize(deserializer)?;
        looking_at(position, look_at, up, field_of_view).map(Self).map_err(serde::de::Error::custom)
    }
}

impl From<Pinhole> for Camera {
    fn from(Pinhole(camera): Pinhole) -> Self {
        camera
    }
}
