//! A quad: four corners in order around the edge, visible from both sides. It is two triangles that share the diagonal
//! from the first to the third corner, or the other one if only that is inside the quad. Its outside is the side from
//! which the corners run counterclockwise.
//!
//! ```toml
//! shape = { quad = { corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]] } }
//! ```

use super::polygon::Cutter;
use super::triangle::points;
use super::{Primitives, Shape, Triangle};
use crate::error::Result;
use crate::math::Vec3;
use crate::scene::library::Files;
use serde::{Deserialize, Deserializer};

/// Four corners; they need not lie in a plane.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Quad {
    /// Its corners, in order around the edge.
    #[serde(deserialize_with = "corners")]
    pub(in crate::scene) corners: [Vec3; 4],
}

/// Cuts a quad into triangles.
fn cut(corners: [Vec3; 4]) -> (Vec<Triangle>, Cutter) {
    let (mut halves, mut cutter) = (Vec::with_capacity(2), Cutter::default());
    cutter.cut(&corners, |corners| halves.push(Triangle { corners }));
    (halves, cutter)
}

/// Reads four corners; neither half may lie on a line.
fn corners<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<[Vec3; 4], D::Error> {
    let corners = points(deserializer)?;
    let (halves, _) = cut(corners);
    if halves.len() != 2 || halves.iter().any(Triangle::is_degenerate) {
        return Err(serde::de::Error::custom("three corners lie on a line (allowed: two triangles with an area)"));
    }
    Ok(corners)
}

impl Shape for Quad {
    fn add_to(self, primitives: &mut Primitives, files: &mut Files<'_>) -> Result<()> {
        let (halves, cutter) = cut(self.corners);
        primitives.triangles.extend(halves);
        for doubt in cutter.doubts() {
            files.remark(format!("{}: {doubt}", files.object));
        }
        Ok(())
    }
}
