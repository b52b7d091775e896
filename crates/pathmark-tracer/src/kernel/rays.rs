//! Ray search alone: the nearest primitive along given rays, without the rest of a path.

use super::render::Counts;
use crate::math::Ray;
use crate::scene::{Scene, SurfaceOrigin, Tests};
use std::sync::Arc;

/// A ray, and the side of the primitive that it starts on, if any.
pub type Start = (Ray, Option<SurfaceOrigin>);

/// The result of a search along rays.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FoundRays {
    /// Rays that met something.
    pub met: u64,
    /// The sum of their distances, in the order of the rays.
    pub distance: f64,
    /// Counts of the rays and of their tests.
    pub counts: Counts,
}

/// Rays, and a method to search along them.
pub trait FirstHits {
    /// Searches along all rays.
    fn search(&self) -> FoundRays;
}

/// One ray at a time.
pub(super) struct ScalarSearch {
    scene: Arc<Scene>,
    rays: Vec<Start>,
}

impl ScalarSearch {
    /// Creates the search in a prepared scene.
    pub(super) fn new(scene: Arc<Scene>, rays: Vec<Start>) -> Self {
        Self { scene, rays }
    }
}

impl FirstHits for ScalarSearch {
    fn search(&self) -> FoundRays {
        let (mut found, mut tests) = (FoundRays::default(), Tests::default());
        for (ray, from) in &self.rays {
            let nearest = self.scene.nearest(ray, *from, f64::MANTISSA_DIGITS, &mut tests);
            if nearest.primitive != u32::MAX {
                found.met += 1;
                found.distance += nearest.t;
            }
        }
        found.counts = Counts {
            rays: self.rays.len() as u64,
            box_tests: tests.boxes,
            primitive_tests: tests.primitives,
            ..Counts::default()
        };
        found
    }
}
