//! How an estimator is executed over a piece of the film. A kernel never sees a thread.

mod choice;
mod inspect;
mod lanes;
mod recursion_clamp;
mod scalar;
mod spec;

use crate::effect::EffectSet;
use crate::error::Result;
use crate::estimator::{self, Estimator, EstimatorVisitor, with_estimator};
use crate::film::{Bounds, Piece, TileBuffer};
use crate::sampling::{
    Independent, SAMPLERS, Sampler, SamplerVisitor, keyed_sampler, stateful_sampler, with_keyed_sampler,
};
use crate::scene::{AllEffects, ProfileVisitor, Scene, SmallptEffects, with_profile};
pub use choice::{Choice, choose};
use choice::{INDEPENDENT, unknown};
pub use inspect::{BounceRow, Event, Inspect, LightByBounce, PathLog, inspect};
use lanes::Lanes;
use recursion_clamp::RecursionClamp;
use scalar::Scalar;
use serde::{Deserialize, Serialize};
pub use spec::{Clamp, Spec};
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

/// One line of the table of kernels.
pub struct Entry {
    /// Its name on the command line, in CSV and TOML.
    pub name: &'static str,
    /// What it is, in a line.
    pub about: &'static str,
}

/// The kernels, in the order in which they are listed.
pub const KERNELS: &[Entry] = &[
    Entry { name: LANES, about: "many paths side by side in SIMD lanes; what it cannot do, the scalar kernel does" },
    Entry { name: SCALAR, about: "one path at a time" },
];

const LANES: &str = "lanes";
const SCALAR: &str = "scalar";

/// The scene with what the accelerator and the estimator need of it.
fn prepared(scene: &Arc<Scene>, spec: &Spec, choice: Choice) -> Arc<Scene> {
    let mut prepared = scene.accelerated(choice.accelerator()).map_or_else(|| Arc::clone(scene), Arc::new);
    if estimator::find(&spec.estimator).is_some_and(|entry| entry.aims) {
        prepared = Arc::new(prepared.lit(&scene.camera.view(spec.width, spec.height)));
    }
    prepared
}

/// Builds the kernel for a scene, and what accelerates it.
pub fn build(scene: &Arc<Scene>, spec: &Spec) -> Result<Box<dyn Kernel>> {
    let choice = choose(scene, spec)?;
    if let Ok(chosen) = choice.lanes {
        return Ok(Box::new(Lanes::new(prepared(scene, spec, choice), spec, chosen)));
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
            with_profile(choice.profile.name, ByProfile { scene, spec: spec.clone() }).flatten()
        }
        None if choice.profile.name == SmallptEffects::NAME => {
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
