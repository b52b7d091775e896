//! What the names of a [`Spec`] come to for a scene: everything that a user could have got wrong is found here.

use super::{Clamp, KERNELS, LANES, SCALAR, Spec};
use crate::error::{InputError, Result};
use crate::estimator::{self, Course, ESTIMATORS, Estimator, EstimatorVisitor, Roulette, with_estimator};
use crate::material::Diffuse;
use crate::sampling::{InLanes as LaneSampler, SAMPLERS, is_deterministic};
use crate::scene::{
    ACCELERATORS, ANGULAR_EMISSION, Accelerator, AllEffects, DiffuseOnly, FOG, HIERARCHY, LENS, POINT_LIGHT, PROFILES,
    ProfileEntry, Scan, Scene, SmallptEffects, Sphere, accelerator, effect_names,
};
use crate::simd::{Entry as Level, LEVELS, Precision, best, widths_of};

/// What effects are called of a kernel that asks at run time whether any of its lanes needs one.
const AT_RUN_TIME: &str = "run-time";

/// What a spec comes to for a scene.
#[derive(Clone, Copy)]
pub struct Choice {
    pub(super) profile: &'static ProfileEntry,
    accelerator: &'static Accelerator,
    /// How lanes go about it, or why they do not.
    pub(super) lanes: std::result::Result<InLanes, &'static str>,
}

/// What lanes are made with.
#[derive(Clone, Copy)]
pub(super) struct InLanes {
    pub(super) level: &'static Level,
    pub(super) precision: Precision,
    pub(super) course: Course,
    pub(super) sampler: LaneSampler,
    /// Whether they are compiled for diffuse surfaces alone.
    pub(super) is_matt: bool,
}

impl Choice {
    /// Name of the kernel that renders.
    pub fn kernel(&self) -> &'static str {
        if self.lanes.is_ok() { LANES } else { SCALAR }
    }

    /// Instruction set of its lanes; empty if it has none.
    pub fn simd(&self) -> &'static str {
        self.lanes.map_or("", |lanes| lanes.level.name)
    }

    /// Floating-point format of what it computes with.
    pub fn precision(&self) -> Precision {
        self.lanes.map_or(Precision::F64, |lanes| lanes.precision)
    }

    /// Why it is not the kernel that was asked for; empty if it is.
    pub fn fallback(&self) -> &'static str {
        self.lanes.err().filter(|reason| *reason != SCALAR).unwrap_or_default()
    }

    /// Name of the smallest effect profile that covers the scene, or of the one that was asked for.
    pub fn profile(&self) -> &'static str {
        self.profile.name
    }

    /// The effects that the kernel was compiled for: a profile's name (of lanes, whose primitives are no part of it), or that it asks at run time.
    pub fn effects(&self) -> &'static str {
        match self.lanes {
            Ok(lanes) if lanes.is_matt => DiffuseOnly::NAME,
            Ok(_) => AT_RUN_TIME,
            Err(_) => self.profile.name,
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

/// The profiles that kernels with a sampler are compiled for; all of them if it is empty. All samplers in all profiles would be more than a
/// hundred kernels, which take minutes to compile.
fn profiles_for(sampler: &str) -> &'static [&'static str] {
    match sampler {
        INDEPENDENT => &[],
        keyed if is_deterministic(keyed) => &[SmallptEffects::NAME, AllEffects::NAME],
        _ => &[AllEffects::NAME],
    }
}

/// Checks every name of the spec and chooses what it leaves open.
pub fn choose(scene: &Scene, spec: &Spec) -> Result<Choice> {
    let lanes = lanes_for(scene, spec)?;
    let scan = match lanes {
        Err(_) => Scan::OneByOne,
        Ok(chosen) => {
            let [lanes, singles] = widths_of(chosen.level, chosen.precision);
            let are_spheres = scene.primitives.effects() == Sphere::EFFECT;
            if are_spheres { Scan::SideBySide(singles) } else { Scan::Blocks(lanes) }
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
    let compiled = profiles_for(&spec.sampler);
    let is_compiled = |name: &str| compiled.is_empty() || compiled.contains(&name);
    let fitting = PROFILES.iter().find(|entry| is_compiled(entry.name) && entry.effects.cover(effects));
    let fitting = fitting.map_or(AllEffects::NAME, |entry| entry.name);
    let wanted = spec.effects.as_deref().unwrap_or(fitting);
    let Some(profile) = PROFILES.iter().find(|entry| entry.name == wanted) else {
        return Err(unknown("effects", wanted, PROFILES.iter().map(|entry| entry.name)).into());
    };
    if !profile.effects.cover(effects) {
        let problem = format!("does not cover the scene, which calls for {}", effect_names(effects));
        return Err(InputError::new("effects", wanted, problem).allowed(fitting).into());
    }
    if !is_compiled(profile.name) {
        let problem = format!("is not compiled for the sampler {}", spec.sampler);
        return Err(InputError::new("effects", wanted, problem).allowed(fitting).into());
    }
    if !SAMPLERS.iter().any(|entry| entry.name == spec.sampler) {
        return Err(unknown("sampler", &spec.sampler, SAMPLERS.iter().map(|entry| entry.name)).into());
    }
    let Some(estimator) = estimator::find(&spec.estimator) else {
        return Err(unknown("estimator", &spec.estimator, ESTIMATORS.iter().map(|entry| entry.name)).into());
    };
    if let Some(depth) = spec.max_depth.filter(|depth| *depth > estimator.largest_depth) {
        let problem = format!("is more than {} can follow", estimator.name);
        let allowed = format!("0 to {}", estimator.largest_depth);
        return Err(InputError::new("max-depth", depth.to_string(), problem).allowed(allowed).into());
    }
    if spec.clamp == Some(Clamp::Recursion) && !estimator.is_one_path {
        let problem = "follows several paths at once, whose recursions are not clamped here";
        let single: Vec<&str> = ESTIMATORS.iter().filter(|entry| entry.is_one_path).map(|entry| entry.name).collect();
        return Err(InputError::new("recursion-clamp", estimator.name, problem).allowed(single.join(", ")).into());
    }
    if let Some(roulette) = &spec.roulette {
        Roulette::parse(roulette)?;
        if estimator.roulette.is_none() {
            let problem = format!("is nothing for {}, which ends no path by chance", estimator.name);
            return Err(InputError::new("roulette", roulette, problem).allowed("none").into());
        }
    }
    Ok(Choice { profile, accelerator, lanes })
}

/// As many primitives as single precision has whole numbers for are more than lanes tell apart.
const MOST_IN_LANES: usize = 1 << f32::MANTISSA_DIGITS;

/// What of a scene or of its settings lanes have no code for.
fn obstacle(scene: &Scene, spec: &Spec) -> Option<&'static str> {
    let features = [(FOG, "fog"), (LENS, "lens"), (POINT_LIGHT, "point-light"), (ANGULAR_EMISSION, "angular-emission")];
    let of_scene = features.into_iter().find(|(effect, _)| scene.effects().cover(*effect)).map(|(_, name)| name);
    let others = [
        (spec.effects.is_some(), "effects"),
        (spec.clamp.is_some(), "clamp"),
        (scene.owners.len() >= MOST_IN_LANES, "primitives"),
    ];
    of_scene.or_else(|| others.into_iter().find(|(is_there, _)| *is_there).map(|(_, name)| name))
}

/// The level on which lanes render a scene with these settings, or why they do not.
fn lanes_for(scene: &Scene, spec: &Spec) -> Result<std::result::Result<InLanes, &'static str>> {
    if !KERNELS.iter().any(|entry| entry.name == spec.kernel) {
        return Err(unknown("kernel", &spec.kernel, KERNELS.iter().map(|entry| entry.name)).into());
    }
    let available = || LEVELS.iter().filter(|level| level.is_available());
    let level = match &spec.simd {
        None => best(),
        Some(name) => match available().find(|level| level.name == *name) {
            Some(level) => level,
            None if LEVELS.iter().any(|level| level.name == *name) => {
                let allowed: Vec<&str> = available().map(|level| level.name).collect();
                let error = InputError::new("simd", name, "is nothing that this processor has");
                return Err(error.allowed(allowed.join(", ")).into());
            }
            None => return Err(unknown("simd", name, available().map(|level| level.name)).into()),
        },
    };
    let precision = precision(spec)?;
    if spec.kernel == SCALAR {
        return Ok(Err(SCALAR));
    }
    Ok(Err(match (obstacle(scene, spec), course(spec), LaneSampler::find(&spec.sampler)) {
        (None, Some(course), Some(sampler)) => {
            let is_diffuse = scene.objects.iter().all(|object| object.material.effect() == Diffuse::EFFECT);
            // Where most of the time goes to lights, being compiled for it would gain 3 %, and takes as long to compile as the others.
            let is_matt = is_diffuse && course.aims.is_none();
            return Ok(Ok(InLanes { level, precision, course, sampler, is_matt }));
        }
        (Some(reason), ..) => reason,
        (None, None, _) => "estimator",
        (None, Some(_), None) => "sampler",
    }))
}

/// The format that the spec names; the scalar kernel has but one.
fn precision(spec: &Spec) -> Result<Precision> {
    let name = &spec.precision;
    let Some(precision) = Precision::ALL.into_iter().find(|precision| precision.name() == name) else {
        return Err(unknown("precision", name, Precision::ALL.into_iter().map(Precision::name)).into());
    };
    if spec.kernel == SCALAR && precision != Precision::F64 {
        let problem = "is nothing for the scalar kernel";
        return Err(InputError::new("precision", name, problem).allowed(Precision::F64.name()).into());
    }
    Ok(precision)
}

/// How the estimator follows paths, if it does.
fn course(spec: &Spec) -> Option<Course> {
    struct OfEstimator;
    impl EstimatorVisitor for OfEstimator {
        type Output = Option<Course>;
        fn visit<E: Estimator + 'static>(self, estimator: E) -> Self::Output {
            estimator.course()
        }
    }
    with_estimator(&spec.estimator, spec.options(), OfEstimator).flatten()
}
