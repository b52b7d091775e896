//! Looking into single samples. What runs is the estimator's own code behind a pointer, with every effect in it; an effect that a scene does not
//! call for changes no bit, so a sample here is what the image was given. That holds in f64; in f32, which lanes alone have, nothing can be looked
//! into but a sample's value ([`super::one_sample`]).

mod by_bounce;
mod path_log;

use super::{Choice, prepared};
use crate::error::{InputError, Result};
use crate::estimator::{AnyEstimator, Probe, camera_ray, seen_besides};
use crate::math::Rgb;
use crate::sampling::{SAMPLERS, SampleKey, Sampler, keyed_sampler};
use crate::scene::{AllEffects, Scene, View};
use crate::simd::Precision;
pub use by_bounce::{BounceRow, LightByBounce};
pub use path_log::{Event, PathLog};
use std::sync::Arc;

/// Renders single samples and tells a probe what their paths do.
pub struct Inspector {
    scene: Arc<Scene>,
    view: View,
    width: u32,
    seed: u64,
    camera_rays: u16,
    estimator: Arc<dyn AnyEstimator>,
    sampler: Box<dyn Sampler>,
}

impl Inspector {
    /// For the samples of an image.
    pub fn new(scene: &Arc<Scene>, choice: &Choice) -> Result<Self> {
        if choice.precision() != Precision::F64 {
            let name = choice.precision().name();
            let problem = "exists in SIMD lanes alone, which do not tell what a path does";
            return Err(InputError::new("precision", name, problem).allowed(Precision::F64.name()).into());
        }
        let Some(sampler) = keyed_sampler(choice.sampler.name) else {
            let problem = "gives other numbers in each run, so that no sample can be had again";
            let names: Vec<&str> =
                SAMPLERS.iter().filter(|entry| entry.deterministic).map(|entry| entry.name).collect();
            return Err(InputError::new("sampler", choice.sampler.name, problem).allowed(names.join(", ")).into());
        };
        Ok(Self {
            scene: prepared(scene, choice)?,
            view: choice.view(scene),
            width: choice.width,
            seed: choice.seed,
            camera_rays: choice.options.camera_rays(),
            estimator: choice.any_estimator()?,
            sampler,
        })
    }

    /// The radiance of a sample as the estimator gives it. An image takes it bit for bit, unless it is no valid radiance: then it
    /// takes nothing.
    pub fn estimate(&self, x: u32, y: u32, sample: u32, mut probe: &mut dyn Probe) -> Rgb {
        let key = SampleKey { seed: self.seed, pixel: y * self.width + x, sample };
        let ray = camera_ray::<Box<dyn Sampler>, AllEffects, &mut dyn Probe>(
            &self.view,
            [x, y],
            key,
            0,
            &self.sampler,
            &mut probe,
        );
        let radiance = self.estimator.estimate(&self.scene, ray, key, &*self.sampler, probe);
        if self.camera_rays == 1 {
            return radiance;
        }
        radiance + seen_besides(&self.scene, &self.view, [x, y], key, self.camera_rays, &*self.sampler, probe)
    }
}
