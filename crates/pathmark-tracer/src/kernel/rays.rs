//! Ray search alone: the nearest primitive along given rays without the rest of a path, for comparison with programs
//! that only search.

use super::lanes::Lanes;
use super::{Choice, Counts, Inspector, prepared};
use crate::error::{InputError, Result};
use crate::estimator::Probe;
use crate::math::{Ray, Rgb, dot};
use crate::scene::{Hit, Scene, Standpoint, Tests};
use crate::simd::{Numbers, Precision};
use std::ops::Range;
use std::sync::Arc;

/// A ray, and the side of the primitive that it starts on, if any.
pub type Start = (Ray, Option<Standpoint>);

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
            Standpoint { primitive: last.primitive, inside }
        });
        self.rays.push((*ray, from));
        self.last = Some(*hit);
    }
    fn ended(&mut self, _bounces: u16) {
        self.last = None;
    }
}

/// Returns the rays of an image's paths, pixel by pixel, without shadow rays and rays that meet nothing. Scenes with
/// fog and estimators that split paths are refused, because their rays start elsewhere.
pub fn path_rays(scene: &Arc<Scene>, choice: &Choice, samples: &Range<u32>) -> Result<Vec<Start>> {
    if !choice.estimator.is_one_path {
        let problem = "follows several paths at once and does not separate their rays";
        return Err(InputError::new("estimator", choice.estimator.name, problem).allowed("bsdf").into());
    }
    if scene.fog.is_some() {
        return Err(InputError::new("scene", &scene.name, "has fog, and rays can start in it")
            .allowed("a scene without fog")
            .into());
    }
    let inspector = Inspector::new(scene, &choice.clone().in_double_precision())?;
    let mut segments = Segments::default();
    for y in 0..choice.height {
        for x in 0..choice.width {
            for sample in samples.clone() {
                inspector.estimate(x, y, sample, &mut segments);
            }
        }
    }
    Ok(segments.rays)
}

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

/// Rays and a method to search along them.
pub struct RaySearch {
    way: Way,
    count: usize,
}

enum Way {
    /// `unit` is the length of the lanes' rays in those of the scene.
    Lanes {
        lanes: Box<Lanes>,
        rays: Numbers,
        unit: f64,
    },
    Scalar {
        scene: Arc<Scene>,
        rays: Vec<Start>,
    },
}

impl RaySearch {
    /// Prepares the search of the kernel that the choice names.
    pub fn new(scene: &Arc<Scene>, choice: &Choice, rays: Vec<Start>) -> Result<Self> {
        let count = rays.len();
        let way = match choice.way.lanes().copied() {
            Some(chosen) => {
                let (scene, factor) = choice.scaled(scene);
                let lanes = Box::new(Lanes::new(&scene, choice, chosen)?);
                let scaled = |(ray, from): &Start| (Ray { origin: ray.origin * factor, ..*ray }, *from);
                let rays = lanes.side_by_side(&rays.iter().map(scaled).collect::<Vec<_>>());
                Way::Lanes { lanes, rays, unit: 1.0 / factor }
            }
            None => Way::Scalar { scene: prepared(scene, choice)?, rays },
        };
        Ok(Self { way, count })
    }

    /// The number of rays.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Searches along all rays.
    pub fn run(&self) -> FoundRays {
        match &self.way {
            Way::Lanes { lanes, rays, unit } => {
                let found = lanes.search(rays, self.count);
                FoundRays { distance: found.distance * unit, ..found }
            }
            Way::Scalar { scene, rays } => {
                let (mut found, mut tests) = (FoundRays::default(), Tests::default());
                for (ray, from) in rays {
                    let nearest = scene.nearest(ray, *from, f64::MANTISSA_DIGITS, &mut tests);
                    if nearest.primitive != u32::MAX {
                        found.met += 1;
                        found.distance += nearest.t;
                    }
                }
                found.counts = Counts {
                    rays: rays.len() as u64,
                    box_tests: tests.boxes,
                    primitive_tests: tests.primitives,
                    ..Counts::default()
                };
                found
            }
        }
    }
}

impl Choice {
    /// The same choice with f64, whose paths are the scalar kernel's.
    fn in_double_precision(mut self) -> Self {
        if let super::way::Way::Lanes(lanes) = &mut self.way {
            lanes.precision = Precision::F64;
        }
        self
    }
}
