//! Kernels: the execution of an estimator over a piece of the film. A kernel knows nothing of threads.

mod beside;
mod choice;
mod clamp;
mod device;
mod in_lanes;
mod inspect;
mod lanes;
mod own;
mod rays;
mod recursion_clamp;
mod scalar;
mod spec;
mod way;
pub mod workload;

use crate::effect::EffectSet;
use crate::error::{Error, Result};
use crate::estimator::{Compiled, Estimator, EstimatorVisitor, with_estimator};
use crate::film::{Bounds, Piece, TileBuffer};
use crate::sampling::{
    Independent, SAMPLERS, Sampler, SamplerVisitor, keyed_sampler, stateful_sampler, with_keyed_sampler,
};
use crate::scene::{AllEffects, ProfileVisitor, Scene, SmallptEffects, with_profile};
use beside::Beside;
pub use choice::{Choice, choose, choose_among};
use choice::{INDEPENDENT, unknown};
pub use clamp::{Clamp, Clamped};
use device::OnDevice;
pub use inspect::{BounceRow, Event, Inspector, LightByBounce, PathLog};
use lanes::Lanes;
pub use own::OwnEstimator;
pub use pathmark_device::{Costs as DeviceCosts, Listed as Device, list as devices};
pub use rays::{FoundRays, RaySearch, Start, path_rays};
use recursion_clamp::RecursionClamp;
use scalar::Scalar;
use serde::{Deserialize, Serialize};
pub use spec::Spec;
use std::marker::PhantomData;
use std::sync::Arc;
use way::Way;

/// Version of the arithmetic. It changes when the same settings produce different bits; films of older versions are
/// then no longer used.
pub const REVISION: u32 = 3;

/// Counts of the events while a piece was rendered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Counts {
    /// Samples.
    pub paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// Samples that were NaN, infinite or negative; they contribute nothing.
    pub invalid: u64,
    /// Rays of paths that met no primitive.
    pub escaped: u64,
    /// Paths cut at the bounce limit.
    pub truncated: u64,
    /// Tests of a ray against a bounding box.
    pub box_tests: u64,
    /// Tests of a ray against a primitive of a hierarchy. Without one, every ray is tested against all primitives.
    pub primitive_tests: u64,
}

impl Counts {
    /// Adds the counts of another piece.
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

/// Renders pieces. With a deterministic sampler, the same piece has the same bits for every caller.
pub trait Kernel: Send + Sync {
    /// Renders the samples of the piece into the buffer, which has the piece's columns and at least its rows.
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts;

    /// Renders pieces, each into its buffer, and returns the counts of each.
    fn render_all(&self, pieces: &[&Piece], out: &mut [TileBuffer]) -> Vec<Counts> {
        pieces.iter().zip(out).map(|(piece, out)| self.render(piece, out)).collect()
    }

    /// Devices that render pieces while the callers of this kernel render others.
    fn beside(&self) -> Vec<&dyn Kernel> {
        Vec::new()
    }

    /// Remarks for the user on the rendering, besides counts.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }

    /// Time spent on programs for devices, if the kernel has any.
    fn costs(&self) -> Option<DeviceCosts> {
        None
    }

    /// The system error that prevented the rendering of pieces, if any. Their buffers are then invalid.
    fn failure(&self) -> Option<Error> {
        None
    }
}

/// One line of the table of kernels.
pub struct Entry {
    /// Its name on the command line, in CSV and TOML.
    pub name: &'static str,
    /// A description in one line.
    pub about: &'static str,
}

/// The kernels, in the order in which they are listed.
pub const KERNELS: &[Entry] = &[
    Entry { name: LANES, about: "many paths side by side in SIMD lanes; falls back to the scalar kernel if needed" },
    Entry { name: SCALAR, about: "one path at a time" },
];

/// The kernel for devices. `device` selects the first GPU, `device:ID` the device of that name, `lanes+device:ID` lanes
/// and a device together.
pub const DEVICE_KERNEL: Entry =
    Entry { name: DEVICE, about: "on a device, bit-identical to the others; `lanes+device:ID` renders on both" };

const DEVICE: &str = "device";
const LANES: &str = "lanes";
const SCALAR: &str = "scalar";

/// Returns the scene with the hierarchy, the lights and the epsilon that the choice requires.
fn prepared(scene: &Arc<Scene>, choice: &Choice) -> Result<Arc<Scene>> {
    let mut prepared = Arc::clone(scene);
    let hierarchy = choice.hierarchy(scene)?;
    if hierarchy.is_some() {
        Arc::make_mut(&mut prepared).hierarchy = hierarchy;
    }
    if choice.estimator.aims {
        Arc::make_mut(&mut prepared).add_lights(&choice.view(scene));
    }
    if choice.epsilon.is_some() {
        Arc::make_mut(&mut prepared).epsilon = choice.epsilon;
    }
    Ok(prepared)
}

/// Builds the kernel for a scene, with its accelerator, from the names of built-in parts.
pub fn build(scene: &Arc<Scene>, spec: &Spec) -> Result<Box<dyn Kernel>> {
    construct(scene, &choose(scene, spec)?)
}

/// Builds an inspector for samples of a scene, from the names of built-in parts.
pub fn inspect(scene: &Arc<Scene>, spec: &Spec) -> Result<Inspector> {
    Inspector::new(scene, &choose(scene, spec)?)
}

/// Builds the kernel for a scene, with its accelerator.
pub fn construct(unscaled: &Arc<Scene>, choice: &Choice) -> Result<Box<dyn Kernel>> {
    let (scene, _) = &choice.scaled(unscaled);
    match &choice.way {
        Way::Lanes(chosen) => return Ok(Box::new(Lanes::new(scene, choice, *chosen)?)),
        Way::Device(chosen) => {
            let prepared = prepared(scene, choice)?;
            return Ok(Box::new(OnDevice::new(&prepared, choice, chosen)?));
        }
        Way::Beside { own, devices, .. } => {
            let prepared = prepared(scene, choice)?;
            let devices =
                devices.iter().map(|device| OnDevice::new(&prepared, choice, device)).collect::<Result<_>>()?;
            return Ok(Box::new(Beside { own: construct(unscaled, &choice.by(own))?, devices }));
        }
        Way::Scalar { .. } => {}
    }
    if let Some(Clamp { what: Clamped::Recursion, limit }) = choice.clamp {
        return Ok(Box::new(RecursionClamp { inspector: Inspector::new(scene, choice)?, limit }));
    }
    let scene = prepared(scene, choice)?;
    let name = choice.sampler.name;
    if let Some(own) = &choice.own {
        let sampler = keyed_sampler(name).or_else(|| stateful_sampler(name, choice.seed));
        let unknown = || unknown("sampler", name, SAMPLERS.iter().map(|entry| entry.name));
        return Ok(own.kernel(scene, choice, sampler.ok_or_else(unknown)?));
    }
    let kernel = match stateful_sampler(name, choice.seed) {
        Some(sampler) => BySampler::<AllEffects>::new(scene, choice).visit(sampler),
        None if choice.profile.name == SmallptEffects::NAME => {
            with_keyed_sampler(name, BySampler::<SmallptEffects>::new(scene, choice)).flatten()
        }
        None if name == INDEPENDENT => with_profile(choice.profile.name, ByProfile { scene, choice }).flatten(),
        None => with_keyed_sampler(name, BySampler::<AllEffects>::new(scene, choice)).flatten(),
    };
    // Every name has been checked, so there is a kernel.
    kernel.ok_or_else(|| unknown("kernel", choice.kernel(), KERNELS.iter().map(|entry| entry.name)).into())
}

/// Renders a single sample. Returns its contribution to the image's sum, and its counts. Its bits are the same as in a
/// whole image.
pub fn one_sample(kernel: &dyn Kernel, [x, y]: [u32; 2], sample: u32) -> ([f64; 3], Counts) {
    let bounds = Bounds { x0: x, y0: y, x1: x + 1, y1: y + 1 };
    let mut buffer = TileBuffer::new(bounds);
    let counts = kernel.render(&Piece { bounds, samples: sample..sample + 1 }, &mut buffer);
    (buffer.row_mut(y)[0].sum, counts)
}

/// Maps the profile's name to a type.
struct ByProfile<'a> {
    scene: Arc<Scene>,
    choice: &'a Choice,
}

impl ProfileVisitor for ByProfile<'_> {
    type Output = Option<Box<dyn Kernel>>;
    fn visit<X: EffectSet>(self) -> Self::Output {
        BySampler::<X>::new(self.scene, self.choice).visit(Independent)
    }
}

/// Maps the sampler's name to a type, then the estimator's.
struct BySampler<'a, X> {
    scene: Arc<Scene>,
    choice: &'a Choice,
    profile: PhantomData<X>,
}

impl<'a, X> BySampler<'a, X> {
    fn new(scene: Arc<Scene>, choice: &'a Choice) -> Self {
        Self { scene, choice, profile: PhantomData }
    }
}

impl<X: EffectSet> SamplerVisitor for BySampler<'_, X> {
    type Output = Option<Box<dyn Kernel>>;
    fn visit<S: Sampler + 'static>(self, sampler: S) -> Self::Output {
        let Self { scene, choice, profile } = self;
        with_estimator(choice.estimator.name, choice.options, ByEstimator::<S, X> { scene, choice, sampler, profile })
    }
}

/// Whether scalar kernels of the estimator are compiled for the profile.
const fn is_compiled<E: Estimator, X: EffectSet>() -> bool {
    match E::COMPILED {
        Compiled::EveryProfile => true,
        Compiled::Common => X::EFFECTS.is(SmallptEffects::EFFECTS) || X::EFFECTS.is(AllEffects::EFFECTS),
        Compiled::WithAllEffects => X::EFFECTS.is(AllEffects::EFFECTS),
    }
}

/// Maps the estimator's name to a type, then to a kernel.
struct ByEstimator<'a, S, X> {
    scene: Arc<Scene>,
    choice: &'a Choice,
    sampler: S,
    profile: PhantomData<X>,
}

impl<S: Sampler + 'static, X: EffectSet> EstimatorVisitor for ByEstimator<'_, S, X> {
    type Output = Box<dyn Kernel>;
    fn visit<E: Estimator + 'static>(self, estimator: E) -> Self::Output {
        let Self { scene, choice, sampler, .. } = self;
        // The condition is a constant, so a profile that is not compiled for takes no compile time. `choose` never asks
        // for one.
        if const { is_compiled::<E, X>() } {
            Box::new(Scalar::<E, S, X>::new(scene, choice, estimator, sampler))
        } else {
            Box::new(Scalar::<E, S, AllEffects>::new(scene, choice, estimator, sampler))
        }
    }
}
