//! Inspection of single samples. The estimator's own code runs behind a pointer, with every effect compiled in. An
//! effect that a scene does not need changes no bit, so an inspected sample equals the image's. This holds in f64. In
//! f32 only a sample's value is available ([`one_sample`](super::one_sample)).

mod by_bounce;
mod path_log;

use super::options::RenderOptions;
use super::render::Counts;
use super::scalar::Samples;
use crate::error::{InputError, Result};
use crate::estimator::{AnyEstimator, Probe, camera_ray, extra_camera_rays};
use crate::math::{Precision, Rgb};
use crate::sampling::{SAMPLERS, SampleKey, Sampler, keyed_sampler};
use crate::scene::{AllEffects, Scene, View};
pub use by_bounce::{BounceRow, LightByBounce};
pub use path_log::{Event, PathLog};
use std::sync::Arc;

/// Renders single samples and reports the events of their paths to a probe.
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
    /// An inspector for the samples of an image, whose kernel renders them in f64.
    pub fn new(scene: &Arc<Scene>, options: &RenderOptions) -> Result<Self> {
        if options.plan.precision() != Precision::F64 {
            let name = options.plan.precision().name();
            let problem = "is rendered by SIMD lanes only, which cannot report the events of a path";
            return Err(InputError::new("precision", name, problem).allowed(Precision::F64.name()).into());
        }
        Self::of_f64(scene, options)
    }

    /// An inspector for the same samples in f64, whatever the kernel's precision is.
    pub(super) fn of_f64(scene: &Arc<Scene>, options: &RenderOptions) -> Result<Self> {
        let Some(sampler) = keyed_sampler(options.sampler.name) else {
            let problem = "returns different numbers in each run, so no sample can be repeated";
            let names: Vec<&str> =
                SAMPLERS.iter().filter(|entry| entry.deterministic).map(|entry| entry.name).collect();
            return Err(InputError::new("sampler", options.sampler.name, problem).allowed(names.join(", ")).into());
        };
        Self::with(options.prepared(scene), options, sampler)
    }

    /// An inspector of a prepared scene, with a given sampler.
    pub(super) fn with(scene: Arc<Scene>, options: &RenderOptions, sampler: Box<dyn Sampler>) -> Result<Self> {
        Ok(Self {
            view: options.view(&scene),
            scene,
            width: options.width,
            seed: options.seed,
            camera_rays: options.options.camera_rays(),
            estimator: options.any_estimator()?,
            sampler,
        })
    }

    /// The radiance of a sample as the estimator returns it. An image takes it bit for bit, or takes nothing if it is
    /// no valid radiance.
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
        radiance + extra_camera_rays(&self.scene, &self.view, [x, y], key, self.camera_rays, &*self.sampler, probe)
    }
}

impl Samples for Inspector {
    fn radiance(&self, x: u32, y: u32, sample: u32, counts: &mut Counts) -> Rgb {
        self.estimate(x, y, sample, counts)
    }
}
