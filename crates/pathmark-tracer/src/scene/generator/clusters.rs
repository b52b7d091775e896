//! Balls in clusters in the cube from -1 to 1. Each cluster has a random centre and a density that decreases around it,
//! so that most of the cube is empty and a few places are crowded.

use super::Made;
use super::spheres::Balls;
use crate::math::Vec3;
use serde::Deserialize;

/// The generator as scene files write it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Clusters {
    /// The number of balls: the number behind the scene's name.
    pub(super) count: u32,
    groups: std::num::NonZeroU16,
    /// The seed of their places and colours.
    seed: u64,
}

/// Half the width of a cluster. An offset is the mean of two uniform ones, so its density is a tent.
const SPREAD: f64 = 0.12;

impl Clusters {
    pub(super) fn make(&self) -> Vec<Made> {
        // The radius that they would have in a cube of a cluster's size.
        let mut balls = Balls::new(
            self.seed,
            SPREAD * 0.5 / libm::cbrt(f64::from(self.count.max(1)) / f64::from(self.groups.get())),
        );
        let centers: Vec<Vec3> = (0..self.groups.get()).map(|_| balls.place() * (1.0 - SPREAD)).collect();
        for index in 0..self.count as usize {
            let offset = (balls.place() + balls.place()) * (0.5 * SPREAD);
            balls.add(centers[index % centers.len()] + offset);
        }
        balls.made
    }
}
