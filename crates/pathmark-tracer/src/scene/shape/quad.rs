//! A quad: four corners in order around the edge, visible from both sides. It is two triangles that share the diagonal
//! from the first to the third corner. Its outside is the side from which the corners run counterclockwise.
//!
//! ```toml
//! shape = { quad = { corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]] } }
//! ```

use super::triangle::points;
use super::{Primitives, Shape, Triangle};
use crate::error::Result;
use crate::math::Vec3;
use crate::scene::source::Files;
use serde::{Deserialize, Deserializer};

/// Four corners; they need not lie in a plane.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Quad {
    /// Its corners, in order around the edge.
    #[serde(deserialize_with = "corners")]
    pub(in crate::scene) corners: [Vec3; 4],
}

fn halves([a, b, c, d]: [Vec3; 4]) -> [Triangle; 2] {
    [Triangle { corners: [a, b, c] }, Triangle { corners: [a, c, d] }]
}

/// Reads four corners; neither half may lie on a line.
fn corners<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<[Vec3; 4], D::Error> {
    let corners = points(deserializer)?;
    if halves(corners).iter().any(Triangle::is_degenerate) {
        return Err(serde::de::Error::custom("three corners lie on a line (allowed: two triangles with an area)"));
    }
    Ok(corners)
}

impl Shape for Quad {
    fn add_to(self, primitives: &mut Primitives, _files: &mut Files<'_>) -> Result<()> {
        primitives.triangles.extend(halves(self.corners));
        Ok(())
    }
}
