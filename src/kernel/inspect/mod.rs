//! Looking into single samples. What runs is the kernel's own code, compiled once more for each estimator with a probe behind a pointer and
//! with every effect in it; an effect that a scene does not call for changes no bit, so a sample here is what the image was given.

mod by_bounce;
mod path_log;

use super::scalar::Scalar;
use super::{Spec, choose, prepared, unknown};
use crate::error::{InputError, Result};
use crate::estimator::{ESTIMATORS, Estimator, EstimatorVisitor, Probe, with_estimator};
use crate::math::Rgb;
use crate::sampling::{SAMPLERS, Sampler, is_deterministic, keyed_sampler};
use crate::scene::{AllEffects, Scene};
pub use by_bounce::{BounceRow, LightByBounce};
pub use path_log::{Event, PathLog};
use std::sync::Arc;

/// Renders single samples and tells a probe what their paths do.
pub trait Inspect: Send + Sync {
    /// The radiance of a sample as the estimator gives it. An image takes it bit for bit, unless it is no valid radiance: then it
    /// takes nothing.
    fn estimate(&self, x: u32, y: u32, sample: u32, probe: &mut dyn Probe) -> Rgb;
}

/// Builds what looks into samples of a scene.
pub fn inspect(scene: &Arc<Scene>, spec: &Spec) -> Result<Box<dyn Inspect>> {
    let choice = choose(scene, spec)?;
    if !is_deterministic(&spec.sampler) {
        let problem = "gives other numbers in each run, so that no sample can be had again";
        let names: Vec<&str> = SAMPLERS.iter().filter(|entry| entry.deterministic).map(|entry| entry.name).collect();
        return Err(InputError::new("sampler", &spec.sampler, problem).allowed(names.join(", ")).into());
    }
    let scene = prepared(scene, spec, choice);
    let inspector = keyed_sampler(&spec.sampler)
        .and_then(|sampler| with_estimator(&spec.estimator, spec.options(), ByEstimator { scene, spec, sampler }));
    // Every name has been checked, so there is one.
    inspector.ok_or_else(|| unknown("estimator", &spec.estimator, ESTIMATORS.iter().map(|entry| entry.name)).into())
}

/// From the estimator's name to a kernel.
struct ByEstimator<'a> {
    scene: Arc<Scene>,
    spec: &'a Spec,
    sampler: Box<dyn Sampler>,
}

impl EstimatorVisitor for ByEstimator<'_> {
    type Output = Box<dyn Inspect>;
    fn visit<E: Estimator + 'static>(self, estimator: E) -> Self::Output {
        Box::new(Scalar::<E, Box<dyn Sampler>, AllEffects>::new(self.scene, self.spec, estimator, self.sampler))
    }
}
