//! Ray search alone: the nearest primitive along given rays, without the rest of a path; and the rays of an image's
//! paths, for comparison with programs that only search.

use super::inspect::Inspector;
use super::options::RenderOptions;
use super::render::Counts;
use crate::error::{InputError, Result};
use crate::estimator::Probe;
use crate::math::{Ray, Rgb, dot};
use crate::scene::{Hit, Scene, SurfaceOrigin, Tests};
use std::ops::Range;
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
    fn search(&self) -> FoundRays;
}

/// One ray at a time.
pub(super) struct ScalarSearch {
    pub(super) scene: Arc<Scene>,
    pub(super) rays: Vec<Start>,
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

/// The rays from vertex to vertex that meet something, in the order of a path.
#[derive(Default)]
struct Segments {
    rays: Vec<Start>,
    last: Option<Hit>,
}

impl Probe for Segments {
    fn vertex(&mut self, _bounces: u16, ray: &Ray, hit: &Hit, _throughput: Rgb) {
        let from = self.last.map(|last| {
            let inside = dot(last.normal, ray.direction) < 0.0;
            SurfaceOrigin { primitive: last.primitive, inside }
        });
        self.rays.push((*ray, from));
        self.last = Some(*hit);
    }
    fn ended(&mut self, _bounces: u16) {
        self.last = None;
    }
}

/// Returns the rays of an image's paths in double precision, pixel by pixel, without shadow rays and rays that meet
/// nothing. Scenes with fog and estimators that split paths are refused, because their rays start elsewhere.
pub fn path_rays(scene: &Arc<Scene>, options: &RenderOptions, samples: &Range<u32>) -> Result<Vec<Start>> {
    if !options.estimator.is_one_path {
        let problem = "follows several paths at once and does not separate their rays";
        return Err(InputError::new("estimator", options.estimator.name, problem).allowed("bsdf").into());
    }
    if scene.fog.is_some() {
        return Err(InputError::new("scene", &scene.name, "has fog, and rays can start in it")
            .allowed("a scene without fog")
            .into());
    }
    let inspector = Inspector::of_f64(scene, options)?;
    let mut segments = Segments::default();
    for y in 0..options.height {
        for x in 0..options.width {
            for sample in samples.clone() {
                inspector.estimate(x, y, sample, &mut segments);
            }
        }
    }
    Ok(segments.rays)
}

/// Rays, and the search of a kernel along them.
pub struct RaySearch {
    hits: Box<dyn FirstHits>,
    /// The length of the search's unit in units of the scene.
    unit: f64,
    count: usize,
}

impl RaySearch {
    /// Prepares the search of the kernel that the options name.
    pub fn new(scene: &Arc<Scene>, options: &RenderOptions, rays: Vec<Start>) -> Result<Self> {
        let count = rays.len();
        let (hits, unit) = options.first_hits(scene, rays)?;
        Ok(Self { hits, unit, count })
    }

    pub fn count(&self) -> usize {
        self.count
    }

    /// Searches along all rays.
    pub fn run(&self) -> FoundRays {
        let found = self.hits.search();
        FoundRays { distance: found.distance * self.unit, ..found }
    }
}
