//! A guard's share of a render: what its operations cost more than the simpler ones, over the time of a sample in a scene
//! that meets it.

use crate::analysis::quantile::median;
use crate::error::Result;
use crate::kernel::Counts;
use crate::measure::{Interleaved, Settings, Setup};
use crate::rendering::spec;
use serde::{Deserialize, Serialize};

/// A scene that meets a guard, and how often a sample does.
pub struct InRender {
    pub scene: &'static str,
    pub often: Often,
}

/// How often a render runs the operation that a guard guards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Often {
    /// So many times in each sample.
    Sample(f64),
    Ray,
    /// At most once at each surface that a path meets: an upper bound where only some surfaces have the material.
    BounceAtMost,
    /// So many times for each primitive that a ray is tested against.
    Test(f64),
}

impl Often {
    pub(super) fn in_words(self) -> String {
        match self {
            Self::Sample(1.0) => "each sample".to_string(),
            Self::Sample(part) => format!("once in {:.0} samples", 1.0 / part),
            Self::Ray => "each ray".to_string(),
            Self::BounceAtMost => "at most each bounce".to_string(),
            Self::Test(_) => "each test of a ray".to_string(),
        }
    }
}

/// The times of a guard in one process: its operations, and beside them a render.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GuardTimes {
    pub operation: Interleaved,
    pub render: RenderTime,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RenderTime {
    pub sample_ns: f64,
    /// Operations of a sample.
    pub operations: f64,
}

impl GuardTimes {
    /// The share of the render's time that the guard costs; negative if it saves time. The extra time is taken from ratios of
    /// adjacent rounds, because drift moves the two medians apart.
    pub(super) fn share(&self) -> f64 {
        let Interleaved { first_ns, ratios, .. } = &self.operation;
        let extra_ns = median(ratios).map_or(f64::NAN, |ratio| first_ns * (1.0 - 1.0 / ratio));
        extra_ns * self.render.operations / self.render.sample_ns
    }
}

/// Renders whose fastest counts: the others met a disturbance.
const RENDERS: usize = 5;

impl InRender {
    /// Renders the scene on one thread with the scalar kernel, whose formulas are those of the guards.
    pub(super) fn time(&self) -> Result<RenderTime> {
        let (scene, spec) = (self.scene.to_string(), spec("bsdf", "scalar", [32, 24], 1));
        let (decomposition, strategy) = ("tiles:16x16".to_string(), "serial".to_string());
        let settings = Settings { scene, spp: 8, spec, decomposition, strategy, threads: 1, ..Settings::default() };
        let setup = Setup::prepare(settings)?;
        let mut fastest = f64::INFINITY;
        let mut operations = 0.0;
        for _ in 0..RENDERS {
            let outcome = setup.run(None)?;
            let samples = 32.0 * 24.0 * 8.0;
            let rays = outcome.counts.rays as f64 / samples;
            operations = match self.often {
                Often::Sample(times) => times,
                Often::Ray => rays,
                Often::BounceAtMost => rays - 1.0,
                Often::Test(times) => times * tests(&outcome.counts, &setup) / samples,
            };
            fastest = fastest.min(1e9 * outcome.makespan_s / samples);
        }
        Ok(RenderTime { sample_ns: fastest, operations })
    }
}

/// Only a hierarchy counts its tests; without one, a ray is tested against all primitives.
fn tests(counts: &Counts, setup: &Setup) -> f64 {
    let all = setup.scene().map_or(0, |(scene, _)| scene.owners.len() as u64);
    if counts.box_tests > 0 { counts.primitive_tests as f64 } else { (counts.rays * all) as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 ns more, 6 times in a sample of 360 ns: 5 %.
    #[test]
    fn a_share_is_the_closed_form() {
        let operation = Interleaved { first_ns: 10.0, second_ns: 7.0, ratios: vec![10.0 / 7.0] };
        let times = GuardTimes { operation, render: RenderTime { sample_ns: 360.0, operations: 6.0 } };
        assert!((times.share() - 0.05).abs() < 1e-15);
    }

    /// In smallpt's box without a hierarchy, a ray is tested against nine spheres, and a path of n vertices has n rays.
    #[test]
    fn operations_are_counted_in_a_render() {
        let of = |often| InRender { scene: "cornell", often }.time().unwrap();
        let (rays, bounces, tests) = (of(Often::Ray), of(Often::BounceAtMost), of(Often::Test(0.5)));
        assert!(rays.operations > 1.0 && rays.sample_ns > 0.0);
        assert_eq!(bounces.operations, rays.operations - 1.0);
        assert!((tests.operations / (0.5 * 9.0 * rays.operations) - 1.0).abs() < 1e-12, "{tests:?} {rays:?}");
        assert_eq!(of(Often::Sample(0.25)).operations, 0.25);
    }
}
