//! How an estimator is executed over a piece of the film. A kernel never sees a thread.

mod inspect;
mod lanes;
mod recursion_clamp;
mod scalar;

use crate::effect::EffectSet;
use crate::error::{InputError, Result};
use crate::estimator::{self, Course, ESTIMATORS, Estimator, EstimatorVisitor, Options, Roulette, with_estimator};
use crate::film::{Bounds, Piece, TileBuffer};
use crate::sampling::{
    InLanes, Independent, SAMPLERS, Sampler, SamplerVisitor, is_deterministic, keyed_sampler, stateful_sampler,
    with_keyed_sampler,
};
use crate::scene::{
    ACCELERATORS, ANGULAR_EMISSION, Accelerator, AllEffects, FOG, HIERARCHY, LENS, POINT_LIGHT, PROFILES, ProfileEntry, ProfileVisitor, Scene, SmallptEffects,
    accelerator, effect_names, with_profile,
};
pub use inspect::{BounceRow, Event, Inspect, LightByBounce, PathLog, inspect};
use lanes::Lanes;
use recursion_clamp::RecursionClamp;
use scalar::Scalar;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Version of the arithmetic. It changes when the same settings give other bits than before, and films of the old ones are no longer used.
pub const REVISION: u32 = 1;

/// What happened while a piece was rendered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Counts {
    /// Samples.
    pub paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// Samples that were NaN, infinite or negative; they contribute nothing.
    pub invalid: u64,
    /// Rays that met nothing.
    pub escaped: u64,
    /// Paths cut at the bounce limit.
    pub truncated: u64,
    /// Boxes that rays were tested against.
    pub box_tests: u64,
    /// Primitives that rays were tested against in a hierarchy; without one every ray is tested against all.
    pub primitive_tests: u64,
}

impl Counts {
    /// Adds another piece's.
    pub fn add(&mut self, other: &Self) {
        self.paths += other.paths;
        self.rays += other.rays;
        self.invalid += other.invalid;
        self.escaped += other.escaped;
        self.truncated += other.truncated;
        self.box_tests += other.box_tests;
        self.primitive_tests += other.primitive_tests;
    }
}

/// Renders pieces. The same piece gives the same bits, whoever asks, if the sampler is deterministic.
pub trait Kernel: Send + Sync {
    /// Renders the samples of the piece into the buffer, which has the piece's columns and at least its rows.
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts;
}

/// What of the light is clamped to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clamp {
    /// The mean of each subpixel before averaging, as smallpt does.
    Subpixel,
    /// What each recursion returns, as report B does.
    Recursion,
}

impl Clamp {
    /// Its name in records.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Subpixel => "subpixel",
            Self::Recursion => "recursion",
        }
    }
}

/// Which kernel to build: the *what* of a render.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Spec {
    /// Columns of the image.
    pub width: u32,
    /// Rows of the image.
    pub height: u32,
    /// Seed of the image.
    pub seed: u64,
    /// Estimator by name.
    pub estimator: String,
    /// Sampler by name.
    pub sampler: String,
    /// Kernel by name.
    pub kernel: String,
    /// Effect profile by name; the smallest that covers the scene if `None`.
    pub effects: Option<String>,
    /// Accelerator by name; the fitting one for so many primitives if `None`.
    pub accelerator: Option<String>,
    /// After so many bounces a path is cut; `None` leaves it to the estimator.
    pub max_depth: Option<u16>,
    /// When and how chance ends paths, as [`Roulette`] reads it; `None` leaves it to the estimator.
    #[serde(default)]
    pub roulette: Option<String>,
    /// What is clamped to 1: biased.
    pub clamp: Option<Clamp>,
}

impl Default for Spec {
    fn default() -> Self {
        Self {
            width: 256,
            height: 192,
            seed: 1,
            estimator: "smallpt".to_string(),
            sampler: "independent".to_string(),
            kernel: "scalar".to_string(),
            effects: None,
            accelerator: None,
            max_depth: None,
            roulette: None,
            clamp: None,
        }
    }
}

impl Spec {
    /// Whether an option is on that changes what the image converges to.
    pub fn is_biased(&self) -> bool {
        self.clamp.is_some() || self.depth().is_some()
    }

    /// What the estimator is told; what cannot be read is what [`choose`] refuses.
    fn options(&self) -> Options {
        let roulette = self.roulette.as_deref().and_then(|text| Roulette::parse(text).ok());
        Options { max_depth: self.max_depth, roulette }
    }

    /// When and how chance ends paths, as [`Roulette`] reads it: what was asked for, or else the estimator's own rule.
    pub fn roulette(&self) -> Option<String> {
        let own = estimator::find(&self.estimator).and_then(|entry| entry.roulette);
        self.options().roulette.or(own).map(|rule| rule.to_string())
    }

    /// After so many bounces a path is cut: what was asked for, or else the estimator's own limit.
    pub fn depth(&self) -> Option<u16> {
        let own = estimator::find(&self.estimator).and_then(|entry| entry.max_depth);
        self.max_depth.or(own)
    }
}

/// One line of the table of kernels.
pub struct Entry {
    /// Its name on the command line, in CSV and TOML.
    pub name: &'static str,
    /// What it is, in a line.
    pub about: &'static str,
}

/// The kernels, in the order in which they are listed.
pub const KERNELS: &[Entry] = &[
    Entry { name: "scalar", about: "one path at a time in f64" },
    Entry { name: LANES, about: "many paths at a time in SIMD lanes; what it cannot do, `scalar` does" },
];

const LANES: &str = "lanes";

/// What a spec comes to for a scene.
#[derive(Clone, Copy)]
pub struct Choice {
    profile: &'static ProfileEntry,
    accelerator: &'static Accelerator,
}

impl Choice {
    /// Name of the effect profile.
    pub fn effects(&self) -> &'static str {
        self.profile.name
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

fn unknown(field: &str, value: &str, names: impl Iterator<Item = &'static str>) -> InputError {
    InputError::new(field, value, "there is none of that name").allowed(names.collect::<Vec<_>>().join(", "))
}

/// The sampler that every profile is compiled for.
const INDEPENDENT: &str = "independent";

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
    let Some(accelerator) = accelerator(spec.accelerator.as_deref(), scene.owners.len()) else {
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
    Ok(Choice { profile, accelerator })
}

/// The scene with what the accelerator and the estimator need of it.
fn prepared(scene: &Arc<Scene>, spec: &Spec, choice: Choice) -> Arc<Scene> {
    let mut prepared = scene.accelerated(choice.accelerator()).map_or_else(|| Arc::clone(scene), Arc::new);
    if estimator::find(&spec.estimator).is_some_and(|entry| entry.aims) {
        prepared = Arc::new(prepared.lit(&scene.camera.view(spec.width, spec.height)));
    }
    prepared
}

/// Why lanes cannot render a scene with these settings; `None` if they can.
fn no_lanes(scene: &Scene, spec: &Spec) -> Option<&'static str> {
    let features = [(FOG, "fog"), (LENS, "lens"), (POINT_LIGHT, "point-light"), (ANGULAR_EMISSION, "angular-emission")];
    if let Some((_, name)) = features.into_iter().find(|(effect, _)| scene.effects().cover(*effect)) {
        return Some(name);
    }
    if spec.clamp.is_some() {
        return Some("clamp");
    }
    if InLanes::find(&spec.sampler).is_none() {
        return Some("sampler");
    }
    course(spec).is_none().then_some("estimator")
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

/// Builds the kernel for a scene, and what accelerates it.
pub fn build(scene: &Arc<Scene>, spec: &Spec) -> Result<Box<dyn Kernel>> {
    let choice = choose(scene, spec)?;
    if spec.kernel == LANES
        && no_lanes(scene, spec).is_none()
        && let (Some(course), Some(sampler)) = (course(spec), InLanes::find(&spec.sampler))
    {
        let level = match std::env::var("PM_SIMD") { Ok(name) => crate::simd::LEVELS.iter().find(|l| l.name == name).unwrap(), _ => crate::simd::best() };
        return Ok(Box::new(Lanes::new(prepared(scene, spec, choice), spec, course, sampler, level)));
    }
    if spec.clamp == Some(Clamp::Recursion) {
        return Ok(Box::new(RecursionClamp(inspect(scene, spec)?)));
    }
    let scene = prepared(scene, spec, choice);
    let spec = spec.clone();
    let name = spec.sampler.clone();
    let kernel = match stateful_sampler(&name, spec.seed) {
        Some(sampler) => BySampler::<AllEffects>::new(scene, spec.clone()).visit(sampler),
        None if name == INDEPENDENT => {
            with_profile(choice.effects(), ByProfile { scene, spec: spec.clone() }).flatten()
        }
        None if choice.effects() == SmallptEffects::NAME => {
            with_keyed_sampler(&name, BySampler::<SmallptEffects>::new(scene, spec.clone())).flatten()
        }
        None => with_keyed_sampler(&name, BySampler::<AllEffects>::new(scene, spec.clone())).flatten(),
    };
    // Every name has been checked, so there is a kernel.
    kernel.ok_or_else(|| unknown("kernel", &spec.kernel, KERNELS.iter().map(|entry| entry.name)).into())
}

/// Builds the kernel of an estimator that is in no table, with every effect and the spec's sampler. What the spec says of the estimator by
/// name (its lights, its multiple of samples) is taken from the table's entry of that name.
pub fn build_of<E: Estimator + 'static>(scene: &Arc<Scene>, spec: &Spec, estimator: E) -> Result<Box<dyn Kernel>> {
    let choice = choose(scene, spec)?;
    let Some(sampler) = keyed_sampler(&spec.sampler) else {
        let names = SAMPLERS.iter().filter(|entry| entry.deterministic).map(|entry| entry.name);
        return Err(unknown("sampler", &spec.sampler, names).into());
    };
    let scene = prepared(scene, spec, choice);
    Ok(Box::new(Scalar::<E, Box<dyn Sampler>, AllEffects>::new(scene, spec, estimator, sampler)))
}

/// What an image is given of one sample, in sum and counts. A kernel that is asked for no more gives the same bits.
pub fn one_sample(kernel: &dyn Kernel, [x, y]: [u32; 2], sample: u32) -> ([f64; 3], Counts) {
    let bounds = Bounds { x0: x, y0: y, x1: x + 1, y1: y + 1 };
    let mut buffer = TileBuffer::new(bounds);
    let counts = kernel.render(&Piece { bounds, samples: sample..sample + 1 }, &mut buffer);
    (buffer.row_mut(y)[0].sum, counts)
}

/// From the profile's name to a type.
struct ByProfile {
    scene: Arc<Scene>,
    spec: Spec,
}

impl ProfileVisitor for ByProfile {
    type Output = Option<Box<dyn Kernel>>;
    fn visit<X: EffectSet>(self) -> Self::Output {
        BySampler::<X>::new(self.scene, self.spec).visit(Independent)
    }
}

/// From the sampler's name to a type, then from the estimator's.
struct BySampler<X> {
    scene: Arc<Scene>,
    spec: Spec,
    profile: std::marker::PhantomData<X>,
}

impl<X> BySampler<X> {
    fn new(scene: Arc<Scene>, spec: Spec) -> Self {
        Self { scene, spec, profile: std::marker::PhantomData }
    }
}

impl<X: EffectSet> SamplerVisitor for BySampler<X> {
    type Output = Option<Box<dyn Kernel>>;
    fn visit<S: Sampler + 'static>(self, sampler: S) -> Self::Output {
        let (name, options) = (self.spec.estimator.clone(), self.spec.options());
        with_estimator(
            &name,
            options,
            ByEstimator::<S, X> { scene: self.scene, spec: self.spec, sampler, profile: self.profile },
        )
    }
}

/// From the estimator's name to a type, then to a kernel.
struct ByEstimator<S, X> {
    scene: Arc<Scene>,
    spec: Spec,
    sampler: S,
    profile: std::marker::PhantomData<X>,
}

impl<S: Sampler + 'static, X: EffectSet> EstimatorVisitor for ByEstimator<S, X> {
    type Output = Box<dyn Kernel>;
    fn visit<E: Estimator + 'static>(self, estimator: E) -> Self::Output {
        Box::new(Scalar::<E, S, X>::new(self.scene, &self.spec, estimator, self.sampler))
    }
}
