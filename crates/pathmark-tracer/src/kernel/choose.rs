//! Resolution of a [`Spec`] for a scene: every error in the user's settings is found here.

use super::clamp::{Clamp, Clamped};
use super::entry::{CustomEstimator, KernelEntry, Planned, Request};
use super::options::{KernelPlan, RenderOptions, unknown};
use super::scalar::{INDEPENDENT, ScalarPlan};
use super::spec::Spec;
use crate::effect::Effects;
use crate::error::{InputError, Result};
use crate::estimator::{Compiled, ESTIMATORS, Entry as EstimatorEntry, Options, Roulette, any_estimator};
use crate::math::Precision;
use crate::sampling::{Entry as SamplerEntry, SAMPLERS};
use crate::scene::{
    ACCELERATORS, Accelerator, AllEffects, EPSILON, FILTERS, Filter, HIERARCHY, PROFILES, ProfileEntry, Scene,
    SmallptEffects, accelerator, effect_names,
};
use std::sync::Arc;

/// The tables from which names are chosen.
#[derive(Clone, Copy)]
pub struct Tables<'a> {
    pub kernels: &'a [KernelEntry],
    /// The estimators that a program added to the built-in ones.
    pub estimators: &'a [CustomEstimator],
}

/// A kernel, and why it is not the requested one.
struct KernelChoice {
    plan: Arc<dyn KernelPlan>,
    fallback: &'static str,
}

/// Chooses the kernel: the requested one, or the scalar kernel where that one has no code for a feature.
fn choose_kernel(request: &Request<'_>, kernels: &[KernelEntry]) -> Result<KernelChoice> {
    let Some(entry) = kernels.iter().find(|entry| entry.is_meant_by(request.kernel)) else {
        return Err(unknown("kernel", request.kernel, kernels.iter().map(|entry| entry.name)).into());
    };
    Ok(match (entry.plan)(request)? {
        Planned::Ready(plan) => KernelChoice { plan, fallback: "" },
        Planned::Unsupported(fallback) => KernelChoice { plan: Arc::new(ScalarPlan), fallback },
    })
}

/// The profiles for which kernels of an estimator and a sampler are compiled; empty for all.
fn profiles_for(estimator: &EstimatorEntry, sampler: &SamplerEntry) -> &'static [&'static str] {
    match estimator.compiled {
        Compiled::EveryProfile if sampler.name == INDEPENDENT => &[],
        Compiled::EveryProfile | Compiled::Common if sampler.deterministic => &[SmallptEffects::NAME, AllEffects::NAME],
        _ => &[AllEffects::NAME],
    }
}

/// Looks up an estimator among the built-in and the user-defined ones.
fn estimator_named(name: &str, custom: &[CustomEstimator]) -> Result<(EstimatorEntry, Option<CustomEstimator>)> {
    if let Some(entry) = ESTIMATORS.iter().find(|entry| entry.name == name) {
        return Ok((*entry, None));
    }
    let Some(found) = custom.iter().find(|custom| custom.entry().name == name) else {
        let names = ESTIMATORS.iter().map(|entry| entry.name).chain(custom.iter().map(|custom| custom.entry().name));
        return Err(unknown("estimator", name, names).into());
    };
    Ok((*found.entry(), Some(found.clone())))
}

/// Checks every name of the spec against the tables, and chooses the settings that it leaves open.
pub fn choose(scene: &Scene, spec: &Spec, tables: Tables<'_>) -> Result<RenderOptions> {
    let Some(sampler) = SAMPLERS.iter().find(|entry| entry.name == spec.sampler) else {
        return Err(unknown("sampler", &spec.sampler, SAMPLERS.iter().map(|entry| entry.name)).into());
    };
    let (mut estimator, custom) = estimator_named(&spec.estimator, tables.estimators)?;
    let mut options = options(spec, &estimator, custom.is_some())?;
    let rules = match &custom {
        Some(custom) => custom.any().any_rules(),
        None => any_estimator(estimator.name, options).and_then(|estimator| estimator.any_rules()),
    };
    if custom.is_some() {
        // A user-defined estimator already has its number of camera rays.
        options.camera_rays = rules.map(|rules| rules.camera_rays).filter(|number| *number != 1);
    }
    let clamp = spec.clamp.as_deref().map(Clamp::parse).transpose()?;
    if let Some(number) = options.camera_rays.filter(|_| clamp.is_some_and(|clamp| clamp.what == Clamped::Recursion)) {
        let problem = "cannot be combined with the recursion clamp, which allows one camera ray";
        return Err(InputError::new("camera-rays", number.to_string(), problem).allowed("1").into());
    }
    let epsilon = epsilon(spec)?;
    let (kernel, simd, precision) = (spec.kernel.as_str(), spec.simd.as_deref(), precision(spec)?);
    let request = Request { scene, spec, kernel, simd, precision, rules, epsilon };
    let KernelChoice { plan, fallback } = choose_kernel(&request, tables.kernels)?;
    if let Some(name) = plan.estimator() {
        estimator.name = name;
    }
    let factor = match plan.precision() {
        Precision::F64 => 1.0,
        Precision::F32 => scene.factor_in_single_precision()?,
    };
    let Some(accelerator) = accelerator(spec.accelerator.as_deref(), scene.owners.len(), plan.scan(scene)) else {
        let names = ACCELERATORS.iter().map(|entry| entry.name);
        return Err(unknown("accelerator", spec.accelerator.as_deref().unwrap_or_default(), names).into());
    };
    let effects = needed_effects(scene, accelerator, epsilon);
    Ok(RenderOptions {
        width: spec.width,
        height: spec.height,
        seed: spec.seed,
        clamp,
        filter: filter(scene, spec)?,
        epsilon,
        profile: profile(effects, spec.effects.as_deref(), &estimator, sampler)?,
        estimator,
        custom,
        options,
        sampler,
        accelerator,
        plan,
        fallback,
        factor,
    })
}

/// The floating-point format that the spec names.
fn precision(spec: &Spec) -> Result<Precision> {
    let names = || Precision::ALL.into_iter().map(Precision::name);
    let found = Precision::ALL.into_iter().find(|precision| precision.name() == spec.precision);
    found.ok_or_else(|| unknown("precision", &spec.precision, names()).into())
}

/// The effects that an image needs: the scene's, and those of its settings.
fn needed_effects(scene: &Scene, accelerator: &Accelerator, epsilon: Option<f64>) -> Effects {
    let mut effects = scene.effects();
    if accelerator.is_hierarchy() {
        effects = effects.and(HIERARCHY);
    }
    if epsilon.is_some() {
        effects = effects.and(EPSILON);
    }
    effects
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
fn options(spec: &Spec, estimator: &EstimatorEntry, is_custom: bool) -> Result<Options> {
    if let Some(depth) = spec.max_depth.filter(|depth| is_custom || *depth > estimator.largest_depth) {
        let problem = format!("is not supported by {}", estimator.name);
        let allowed = if is_custom { "none".to_string() } else { format!("0 to {}", estimator.largest_depth) };
        return Err(InputError::new("max-depth", depth.to_string(), problem).allowed(allowed).into());
    }
    let clamp = spec.clamp.as_deref().map(Clamp::parse).transpose()?;
    if clamp.is_some_and(|clamp| clamp.what == Clamped::Recursion) && !estimator.is_one_path {
        let problem = "follows several paths at once, but the recursion clamp supports only one";
        let single: Vec<&str> = ESTIMATORS.iter().filter(|entry| entry.is_one_path).map(|entry| entry.name).collect();
        return Err(InputError::new("estimator", estimator.name, problem).allowed(single.join(", ")).into());
    }
    let roulette = spec.roulette.as_deref().map(Roulette::parse).transpose()?;
    if let Some(rule) = spec.roulette.as_deref().filter(|_| is_custom || estimator.roulette.is_none()) {
        let problem = format!("is not supported by {}, which takes no roulette rule", estimator.name);
        return Err(InputError::new("roulette", rule, problem).allowed("no rule").into());
    }
    Ok(Options { max_depth: spec.max_depth, roulette, camera_rays: camera_rays(spec, estimator, is_custom)? })
}

/// The requested number of camera rays, if it is not one.
fn camera_rays(spec: &Spec, estimator: &EstimatorEntry, is_custom: bool) -> Result<Option<u16>> {
    let Some(number) = spec.camera_rays.filter(|number| *number != 1) else { return Ok(None) };
    let error = |problem: &str, allowed| InputError::new("camera-rays", number.to_string(), problem).allowed(allowed);
    if number == 0 {
        return Err(error("is out of range", "1 to 65535").into());
    }
    if is_custom || !estimator.shares_camera_rays {
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
