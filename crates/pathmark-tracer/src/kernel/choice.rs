//! Resolution of a [`Spec`] for a scene: every error in the user's settings is found here.

use super::way::{Way, way_for};
use super::{Clamp, Clamped, LANES, OwnEstimator, SCALAR, Spec};
use crate::effect::Effects;
use crate::error::{InputError, Result};
use crate::estimator::{AnyEstimator, Compiled, ESTIMATORS, Entry as EstimatorEntry, Options, Roulette, any_estimator};
use crate::sampling::{Entry as SamplerEntry, SAMPLERS};
use crate::scene::{
    ACCELERATORS, Accelerator, AllEffects, DiffuseOnly, EPSILON, FILTERS, Filter, HIERARCHY, Hierarchy, PROFILES,
    ProfileEntry, SUBPIXELS, Scan, Scene, SmallptEffects, Sphere, TreeStore, View, accelerator, effect_names,
};
use crate::simd::{Precision, Sizes, sizes_of};
use std::sync::Arc;

/// Name for the effects of a kernel that checks at run time whether any of its lanes needs one.
const AT_RUN_TIME: &str = "run-time";

/// A spec resolved for a scene: none of its names has to be looked up again.
#[derive(Clone)]
pub struct Choice {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) seed: u64,
    pub(super) clamp: Option<Clamp>,
    /// The filter, if it is not the camera's own.
    filter: Option<Filter>,
    /// Distance below which nothing is hit.
    pub(super) epsilon: Option<f64>,
    pub(super) estimator: EstimatorEntry,
    /// The estimator, if it is in no table.
    pub(super) own: Option<OwnEstimator>,
    pub(super) options: Options,
    pub(super) sampler: &'static SamplerEntry,
    pub(super) profile: &'static ProfileEntry,
    accelerator: &'static Accelerator,
    /// Store in which hierarchies are looked up and kept.
    trees: Option<Arc<dyn TreeStore>>,
    pub(super) way: Way,
    /// Factor for all lengths, a power of two.
    factor: f64,
}

impl Choice {
    /// The estimator.
    pub fn estimator(&self) -> &EstimatorEntry {
        &self.estimator
    }

    /// The sampler.
    pub fn sampler(&self) -> &'static SamplerEntry {
        self.sampler
    }

    /// The same choice with another seed and without a clamp, for independent samples of the same radiance.
    #[must_use]
    pub fn pilot(self, seed: u64) -> Self {
        Self { seed, clamp: None, ..self }
    }

    /// The same choice with a store of hierarchies, which keeps those that it lacks.
    #[must_use]
    pub fn with_trees(self, store: Arc<dyn TreeStore>) -> Self {
        Self { trees: Some(store), ..self }
    }

    /// Whether the scene's hierarchy is looked up in the store.
    pub fn asks_store(&self, scene: &Scene) -> bool {
        let with_box = scene.primitives.spheres.len() + scene.primitives.triangles.len();
        self.trees.is_some() && self.accelerator.is_kept(with_box)
    }

    /// The scene's hierarchy; `None` if the accelerator has none.
    pub(super) fn hierarchy(&self, scene: &Scene) -> Result<Option<Hierarchy>> {
        scene.hierarchy_by(self.accelerator(), self.trees.as_deref())
    }

    /// The clamp, if any.
    pub fn clamp(&self) -> Option<Clamp> {
        self.clamp
    }

    /// The filter, if it is not the camera's own.
    pub fn filter(&self) -> Option<Filter> {
        self.filter
    }

    /// Distance below which nothing is hit; `None` if the primitive that a ray starts on is known exactly.
    pub fn epsilon(&self) -> Option<f64> {
        self.epsilon
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
        match &self.own {
            Some(own) => Ok(own.any()),
            None => match any_estimator(self.estimator.name, self.options) {
                Some(estimator) => Ok(Arc::from(estimator)),
                None => Err(unknown("estimator", self.estimator.name, ESTIMATORS.iter().map(|e| e.name)).into()),
            },
        }
    }

    /// The same choice with another kernel.
    pub(super) fn by(&self, way: &Way) -> Self {
        Self { way: way.clone(), ..self.clone() }
    }

    /// Number of devices that render beside the workers.
    pub fn devices_beside(&self) -> usize {
        if let Way::Beside { devices, .. } = &self.way { devices.len() } else { 0 }
    }

    /// Whether the choice requires a GPU and there is none. No kernel can be built then.
    pub fn lacks_device(&self) -> bool {
        matches!(&self.way, Way::Device(device) if device.id.is_none())
    }

    /// Name of the kernel that renders. For a device it includes the device's name: `device:cuda:0`.
    pub fn kernel(&self) -> &str {
        match &self.way {
            Way::Lanes(_) => LANES,
            Way::Device(device) => &device.kernel,
            Way::Beside { kernel, .. } => kernel,
            Way::Scalar { .. } => SCALAR,
        }
    }

    /// Instruction set of the lanes; empty without lanes.
    pub fn simd(&self) -> &'static str {
        self.way.lanes().map_or("", |lanes| lanes.level.name())
    }

    /// Floating-point format of the computation.
    pub fn precision(&self) -> Precision {
        self.way.precision()
    }

    /// The scene in the lengths of the computation, and their factor.
    pub(super) fn scaled(&self, scene: &Arc<Scene>) -> (Arc<Scene>, f64) {
        let is_scaled = self.factor != 1.0;
        (if is_scaled { Arc::new(scene.scaled(self.factor)) } else { Arc::clone(scene) }, self.factor)
    }

    /// Reason why the scalar kernel replaces the requested one; empty if it does not.
    pub fn fallback(&self) -> &'static str {
        if let Way::Scalar { instead_because } = self.way { instead_because } else { "" }
    }

    /// Name of the effect profile: the requested one, or the smallest one that covers the scene.
    pub fn profile(&self) -> &'static str {
        self.profile.name
    }

    /// The effects that the kernel was compiled for: the name of a profile, or `run-time` for lanes that check at run
    /// time. A profile of lanes does not include primitives.
    pub fn effects(&self) -> &'static str {
        match &self.way {
            Way::Device(_) | Way::Scalar { .. } => self.profile.name,
            way => match way.lanes() {
                Some(lanes) if lanes.is_diffuse_only => DiffuseOnly::NAME,
                Some(_) => AT_RUN_TIME,
                None => self.profile.name,
            },
        }
    }

    /// Name of the accelerator.
    pub fn accelerator(&self) -> &'static str {
        self.accelerator.name
    }

    /// Whether rays are tested against boxes before primitives.
    pub fn is_hierarchical(&self) -> bool {
        self.accelerator.is_hierarchy()
    }
}

pub(super) fn unknown(field: &str, value: &str, names: impl Iterator<Item = &'static str>) -> InputError {
    InputError::new(field, value, "there is none of that name").allowed(names.collect::<Vec<_>>().join(", "))
}

/// The sampler that every profile is compiled for.
pub(super) const INDEPENDENT: &str = "independent";

/// The profiles for which kernels of an estimator and a sampler are compiled; empty for all.
fn profiles_for(estimator: &EstimatorEntry, sampler: &SamplerEntry) -> &'static [&'static str] {
    match estimator.compiled {
        Compiled::EveryProfile if sampler.name == INDEPENDENT => &[],
        Compiled::EveryProfile | Compiled::Common if sampler.deterministic => &[SmallptEffects::NAME, AllEffects::NAME],
        _ => &[AllEffects::NAME],
    }
}

/// Looks up an estimator among the built-in and the user-defined ones.
fn estimator_named(name: &str, own: &[OwnEstimator]) -> Result<(EstimatorEntry, Option<OwnEstimator>)> {
    if let Some(entry) = ESTIMATORS.iter().find(|entry| entry.name == name) {
        return Ok((*entry, None));
    }
    let Some(found) = own.iter().find(|own| own.entry().name == name) else {
        let names = ESTIMATORS.iter().map(|entry| entry.name).chain(own.iter().map(|own| own.entry().name));
        return Err(unknown("estimator", name, names).into());
    };
    Ok((*found.entry(), Some(found.clone())))
}

/// Checks every name of the spec against the built-in tables, and chooses the settings that it leaves open.
pub fn choose(scene: &Scene, spec: &Spec) -> Result<Choice> {
    choose_among(scene, spec, &[])
}

/// Like [`choose`], with user-defined estimators besides the built-in ones.
pub fn choose_among(scene: &Scene, spec: &Spec, own: &[OwnEstimator]) -> Result<Choice> {
    let Some(sampler) = SAMPLERS.iter().find(|entry| entry.name == spec.sampler) else {
        return Err(unknown("sampler", &spec.sampler, SAMPLERS.iter().map(|entry| entry.name)).into());
    };
    let (estimator, own) = estimator_named(&spec.estimator, own)?;
    let mut options = options(spec, &estimator, own.is_some())?;
    let rules = match &own {
        Some(own) => own.any().any_rules(),
        None => any_estimator(estimator.name, options).and_then(|estimator| estimator.any_rules()),
    };
    if own.is_some() {
        // A user-defined estimator already has its number of camera rays.
        options.camera_rays = rules.map(|rules| rules.camera_rays).filter(|number| *number != 1);
    }
    let clamp = spec.clamp.as_deref().map(Clamp::parse).transpose()?;
    if let Some(number) = options.camera_rays.filter(|_| clamp.is_some_and(|clamp| clamp.what == Clamped::Recursion)) {
        let problem = "cannot be combined with the recursion clamp, which allows one camera ray";
        return Err(InputError::new("camera-rays", number.to_string(), problem).allowed("1").into());
    }
    let epsilon = epsilon(spec)?;
    let way = way_for(scene, spec, rules, epsilon)?;
    let factor = match way.precision() {
        Precision::F64 => 1.0,
        Precision::F32 => scene.factor_in_single_precision()?,
    };
    let scan = match way.lanes() {
        None => Scan::OneByOne,
        Some(chosen) => {
            let Sizes { lanes, single, .. } = sizes_of(chosen.level, chosen.precision);
            match chosen.precision {
                _ if scene.primitives.effects() == Sphere::EFFECT => Scan::Spheres(single),
                Precision::F64 => Scan::Doubles(lanes),
                Precision::F32 => Scan::Singles(lanes),
            }
        }
    };
    let Some(accelerator) = accelerator(spec.accelerator.as_deref(), scene.owners.len(), scan) else {
        let names = ACCELERATORS.iter().map(|entry| entry.name);
        return Err(unknown("accelerator", spec.accelerator.as_deref().unwrap_or_default(), names).into());
    };
    let mut effects = scene.effects();
    if accelerator.is_hierarchy() {
        effects = effects.and(HIERARCHY);
    }
    if epsilon.is_some() {
        effects = effects.and(EPSILON);
    }
    Ok(Choice {
        width: spec.width,
        height: spec.height,
        seed: spec.seed,
        clamp,
        filter: filter(scene, spec)?,
        epsilon,
        profile: profile(effects, spec.effects.as_deref(), &estimator, sampler)?,
        estimator,
        own,
        options,
        sampler,
        accelerator,
        trees: None,
        way,
        factor,
    })
}

/// The requested profile, or else the smallest one that covers the effects and is compiled for estimator and sampler.
fn profile(
    effects: Effects,
    wanted: Option<&str>,
    estimator: &EstimatorEntry,
    sampler: &SamplerEntry,
) -> Result<&'static ProfileEntry> {
    let compiled = profiles_for(estimator, sampler);
    let is_compiled = |name: &str| compiled.is_empty() || compiled.contains(&name);
    let fitting = PROFILES.iter().find(|entry| is_compiled(entry.name) && entry.effects.cover(effects));
    let fitting = fitting.map_or(AllEffects::NAME, |entry| entry.name);
    let wanted = wanted.unwrap_or(fitting);
    let Some(profile) = PROFILES.iter().find(|entry| entry.name == wanted) else {
        return Err(unknown("effects", wanted, PROFILES.iter().map(|entry| entry.name)).into());
    };
    if !profile.effects.cover(effects) {
        let problem = format!("does not cover the scene, which needs {}", effect_names(effects));
        return Err(InputError::new("effects", wanted, problem).allowed(fitting).into());
    }
    if !is_compiled(profile.name) {
        let problem = format!("is not compiled for {} with the sampler {}", estimator.name, sampler.name);
        return Err(InputError::new("effects", wanted, problem).allowed(fitting).into());
    }
    Ok(profile)
}

/// The options for the estimator. Options that it does not have are errors.
fn options(spec: &Spec, estimator: &EstimatorEntry, is_own: bool) -> Result<Options> {
    if let Some(depth) = spec.max_depth.filter(|depth| is_own || *depth > estimator.largest_depth) {
        let problem = format!("is not supported by {}", estimator.name);
        let allowed = if is_own { "none".to_string() } else { format!("0 to {}", estimator.largest_depth) };
        return Err(InputError::new("max-depth", depth.to_string(), problem).allowed(allowed).into());
    }
    let clamp = spec.clamp.as_deref().map(Clamp::parse).transpose()?;
    if clamp.is_some_and(|clamp| clamp.what == Clamped::Recursion) && !estimator.is_one_path {
        let problem = "follows several paths at once, but the recursion clamp supports only one";
        let single: Vec<&str> = ESTIMATORS.iter().filter(|entry| entry.is_one_path).map(|entry| entry.name).collect();
        return Err(InputError::new("estimator", estimator.name, problem).allowed(single.join(", ")).into());
    }
    let roulette = spec.roulette.as_deref().map(Roulette::parse).transpose()?;
    if let Some(rule) = spec.roulette.as_deref().filter(|_| is_own || estimator.roulette.is_none()) {
        let problem = format!("is not supported by {}, which takes no roulette rule", estimator.name);
        return Err(InputError::new("roulette", rule, problem).allowed("no rule").into());
    }
    Ok(Options { max_depth: spec.max_depth, roulette, camera_rays: camera_rays(spec, estimator, is_own)? })
}

/// The requested number of camera rays, if it is not one.
fn camera_rays(spec: &Spec, estimator: &EstimatorEntry, is_own: bool) -> Result<Option<u16>> {
    let Some(number) = spec.camera_rays.filter(|number| *number != 1) else { return Ok(None) };
    let error = |problem: &str, allowed| InputError::new("camera-rays", number.to_string(), problem).allowed(allowed);
    if number == 0 {
        return Err(error("is out of range", "1 to 65535").into());
    }
    if is_own || !estimator.shares_camera_rays {
        return Err(error(&format!("{} allows one camera ray", estimator.name), "1").into());
    }
    Ok(Some(number))
}

/// The filter that the spec names, if it is not the camera's own.
fn filter(scene: &Scene, spec: &Spec) -> Result<Option<Filter>> {
    let Some(name) = spec.filter.as_deref() else { return Ok(None) };
    let Some(entry) = FILTERS.iter().find(|entry| entry.name == name) else {
        return Err(unknown("filter", name, FILTERS.iter().map(|entry| entry.name)).into());
    };
    Ok(Some(entry.filter).filter(|filter| *filter != scene.camera.filter))
}

/// The distance below which nothing is hit, if one is requested.
fn epsilon(spec: &Spec) -> Result<Option<f64>> {
    let Some(text) = spec.epsilon.as_deref().filter(|text| *text != "none") else { return Ok(None) };
    let parsed = text.parse().ok().filter(|distance: &f64| distance.is_finite() && *distance >= 0.0);
    let error = || {
        InputError::new("epsilon", text, "is not a valid distance")
            .allowed("a number of at least 0, in the scene's units of length, or `none`")
    };
    parsed.map(Some).ok_or_else(|| error().into())
}
