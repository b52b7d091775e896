//! The settings of a render, resolved for a scene, and the plan of a kernel that is built from them.

use super::clamp::Clamp;
use super::entry::CustomEstimator;
use super::rays::{FirstHits, Start};
use super::render::Kernel;
use crate::error::{InputError, Result};
use crate::estimator::{AnyEstimator, ESTIMATORS, Entry as EstimatorEntry, Options, Roulette, any_estimator};
use crate::math::Precision;
use crate::sampling::Entry as SamplerEntry;
use crate::scene::{Accelerator, Filter, Hierarchy, ProfileEntry, SUBPIXELS, Scan, Scene, View};
use std::sync::Arc;

/// A kernel that has been chosen for a scene, before it is built.
pub trait KernelPlan: Send + Sync {
    /// The kernel's name in rows; for a device with the device's name, as in `device:cuda:0`.
    fn name(&self) -> &str;

    /// Instruction set of its lanes; empty without lanes.
    fn simd(&self) -> &'static str {
        ""
    }

    /// Floating-point format of the computation.
    fn precision(&self) -> Precision {
        Precision::F64
    }

    /// The name of its estimator if it has one of its own instead of the requested one: its images are then never
    /// taken for images of another estimator.
    fn estimator(&self) -> Option<&'static str> {
        None
    }

    /// The effects that its code is for, in rows; `None` for the effect profile of the scene.
    fn effects(&self) -> Option<&'static str> {
        None
    }

    /// How it tests primitives without a hierarchy, which decides from how many primitives on a hierarchy is faster.
    fn scan(&self, _scene: &Scene) -> Scan {
        Scan::OneByOne
    }

    /// Number of devices that render beside the workers.
    fn devices_beside(&self) -> usize {
        0
    }

    /// Whether the kernel needs a GPU and there is none. It cannot be built then.
    fn lacks_device(&self) -> bool {
        false
    }

    /// Builds the kernel for a scene in the lengths of the computation.
    fn build(&self, scene: &Arc<Scene>, options: &RenderOptions) -> Result<Box<dyn Kernel>>;

    /// Prepares a search for the first hits along rays, all in the lengths of the computation.
    fn first_hits(
        &self,
        _scene: &Arc<Scene>,
        _options: &RenderOptions,
        _rays: Vec<Start>,
    ) -> Result<Box<dyn FirstHits>> {
        let problem = "cannot search along given rays, without the rest of their paths";
        Err(InputError::new("kernel", self.name(), problem).allowed("lanes, scalar").into())
    }
}

/// The resolved settings: none of their names has to be looked up again.
#[derive(Clone)]
pub struct RenderOptions {
    pub width: u32,
    pub height: u32,
    pub seed: u64,
    pub clamp: Option<Clamp>,
    /// The filter, if it is not the camera's own.
    pub filter: Option<Filter>,
    /// Distance below which nothing is hit; `None` if the primitive that a ray starts on is known exactly.
    pub epsilon: Option<f64>,
    pub estimator: EstimatorEntry,
    /// The estimator, if a program added it.
    pub(super) custom: Option<CustomEstimator>,
    pub(super) options: Options,
    pub sampler: &'static SamplerEntry,
    /// The requested effect profile, or the smallest one that covers the scene.
    pub profile: &'static ProfileEntry,
    pub accelerator: &'static Accelerator,
    /// The plan of the kernel that renders.
    pub plan: Arc<dyn KernelPlan>,
    /// Reason why the scalar kernel replaces the requested one; empty if it does not.
    pub fallback: &'static str,
    /// Factor for all lengths, a power of two.
    pub(super) factor: f64,
}

impl RenderOptions {
    /// The same options with another seed and without a clamp, for independent samples of the same radiance.
    #[must_use]
    pub fn pilot(self, seed: u64) -> Self {
        Self { seed, clamp: None, ..self }
    }

    /// The scene's hierarchy; `None` if the accelerator has none.
    pub fn hierarchy(&self, scene: &Scene) -> Option<Hierarchy> {
        scene.hierarchy_by(self.accelerator.name)
    }

    /// The scene's camera set up for the image.
    pub fn view(&self, scene: &Scene) -> View {
        scene.camera.view(self.width, self.height).filtered(self.filter)
    }

    /// Number of subpixels over which a pixel's samples are spread in turn; 1 without subpixels.
    pub fn subpixels(&self, scene: &Scene) -> u32 {
        if self.filter.unwrap_or(scene.camera.filter) == Filter::Tent { SUBPIXELS } else { 1 }
    }

    /// The rule of Russian roulette: the requested one, or else the estimator's own.
    pub fn roulette(&self) -> Option<Roulette> {
        self.options.roulette.or(self.estimator.roulette)
    }

    /// Bounces after which a path is cut: the requested number, or else the estimator's own limit.
    pub fn depth(&self) -> Option<u16> {
        self.options.max_depth.or(self.estimator.max_depth)
    }

    /// Camera rays per sample.
    pub fn camera_rays(&self) -> u16 {
        self.options.camera_rays()
    }

    /// Whether an option changes the limit to which the image converges.
    pub fn is_biased(&self) -> bool {
        self.clamp.is_some() || self.depth().is_some() || self.filter.is_some() || self.epsilon.is_some()
    }

    /// The estimator behind a pointer.
    pub(super) fn any_estimator(&self) -> Result<Arc<dyn AnyEstimator>> {
        match &self.custom {
            Some(custom) => Ok(custom.any()),
            None => match any_estimator(self.estimator.name, self.options) {
                Some(estimator) => Ok(Arc::from(estimator)),
                None => Err(unknown("estimator", self.estimator.name, ESTIMATORS.iter().map(|e| e.name)).into()),
            },
        }
    }

    /// The effects that the kernel was compiled for: the name of a profile, or `run-time` for lanes that check at run
    /// time. A profile of lanes does not include primitives.
    pub fn effects(&self) -> &'static str {
        self.plan.effects().unwrap_or(self.profile.name)
    }

    /// Whether rays are tested against boxes before primitives.
    pub fn is_hierarchical(&self) -> bool {
        self.accelerator.is_hierarchy()
    }

    /// The scene with the hierarchy, the lights and the epsilon that the options require.
    pub fn prepared(&self, scene: &Arc<Scene>) -> Arc<Scene> {
        let mut prepared = Arc::clone(scene);
        let hierarchy = self.hierarchy(scene);
        if hierarchy.is_some() {
            Arc::make_mut(&mut prepared).hierarchy = hierarchy;
        }
        if self.estimator.aims {
            Arc::make_mut(&mut prepared).lights = Some(scene.lights_for(&self.view(scene)));
        }
        if self.epsilon.is_some() {
            Arc::make_mut(&mut prepared).epsilon = self.epsilon;
        }
        prepared
    }

    /// The scene in the lengths of the computation, and their factor.
    fn scaled(&self, scene: &Arc<Scene>) -> (Arc<Scene>, f64) {
        let is_scaled = self.factor != 1.0;
        (if is_scaled { Arc::new(scene.scaled(self.factor)) } else { Arc::clone(scene) }, self.factor)
    }

    /// Builds the kernel for the scene, with its accelerator.
    pub fn build(&self, scene: &Arc<Scene>) -> Result<Box<dyn Kernel>> {
        self.plan.build(&self.scaled(scene).0, self)
    }

    /// Prepares the kernel's search along rays. Returns the length of the search's unit in units of the scene, too.
    pub(super) fn first_hits(&self, scene: &Arc<Scene>, mut rays: Vec<Start>) -> Result<(Box<dyn FirstHits>, f64)> {
        let (scene, factor) = self.scaled(scene);
        for (ray, _) in &mut rays {
            ray.origin = ray.origin * factor;
        }
        Ok((self.plan.first_hits(&scene, self, rays)?, 1.0 / factor))
    }
}

/// The error for a name that is in no table.
pub fn unknown<'a>(field: &str, value: &str, names: impl Iterator<Item = &'a str>) -> InputError {
    InputError::new(field, value, "there is none of that name").allowed(names.collect::<Vec<_>>().join(", "))
}
