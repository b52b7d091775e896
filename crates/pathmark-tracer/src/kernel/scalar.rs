//! One path at a time, in f64: the readable kernel that every other one is measured against; its entry, and the choice of
//! its compiled code.
//!
//! With the sampler `independent` the whole path is compiled as one function for each estimator and several effect
//! profiles. Other samplers are called through pointers: in scenes of smallpt's effects by compiled estimators, in other
//! scenes by estimators that are pointers, too. Each copy of the path takes a second to compile, and pointers cost these
//! renders up to a fifth of their time (docs/notes/tried.md).

use super::clamp::{Clamp, Clamped};
use super::entry::{KernelEntry, Planned, Request};
use super::inspect::Inspector;
use super::options::{KernelPlan, RenderOptions, unknown};
use super::rays::{FirstHits, ScalarSearch, Start};
use super::recursion_clamp::RecursionClamp;
use super::render::{Counts, Kernel};
use crate::effect::EffectSet;
use crate::error::{InputError, Result};
use crate::estimator::{
    Compiled as CompiledFor, Estimator, EstimatorVisitor, Probe, camera_ray, extra_camera_rays, with_estimator,
};
use crate::film::{Piece, PixelSum, SampleSum, TileBuffer};
use crate::math::{Precision, Rgb};
use crate::sampling::{Independent, SAMPLERS, SampleKey, Sampler, keyed_sampler, stateful_sampler};
use crate::scene::{AllEffects, ProfileVisitor, SUBPIXELS, Scene, SmallptEffects, Tests, View, with_profile};
use std::marker::PhantomData;
use std::sync::Arc;

impl Probe for Counts {
    #[inline(always)]
    fn ray(&mut self, tests: Tests) {
        self.rays += 1;
        self.box_tests += tests.boxes;
        self.primitive_tests += tests.primitives;
    }
    fn escaped(&mut self) {
        self.escaped += 1;
    }
    fn truncated(&mut self) {
        self.truncated += 1;
    }
}

/// A source of samples: the radiance of each, and the counts of its rays.
pub(super) trait Samples: Send + Sync {
    /// The radiance of a sample of the pixel in column `x` of row `y`, as it is estimated, valid or not.
    fn radiance(&self, x: u32, y: u32, sample: u32, counts: &mut Counts) -> Rgb;
}

/// Samples of an estimator that is compiled for one sampler and one effect profile.
pub(super) struct Compiled<E, S, X> {
    scene: Arc<Scene>,
    view: View,
    width: u32,
    seed: u64,
    camera_rays: u16,
    estimator: E,
    sampler: S,
    profile: PhantomData<X>,
}

impl<E, S, X> Compiled<E, S, X> {
    /// The samples of an image of a prepared scene.
    pub(super) fn new(scene: Arc<Scene>, options: &RenderOptions, estimator: E, sampler: S) -> Self {
        Self {
            view: options.view(&scene),
            scene,
            width: options.width,
            seed: options.seed,
            camera_rays: options.options.camera_rays(),
            estimator,
            sampler,
            profile: PhantomData,
        }
    }
}

impl<E: Estimator, S: Sampler, X: EffectSet> Samples for Compiled<E, S, X> {
    #[inline(always)]
    fn radiance(&self, x: u32, y: u32, sample: u32, counts: &mut Counts) -> Rgb {
        let key = SampleKey { seed: self.seed, pixel: y * self.width + x, sample };
        let ray = camera_ray::<S, X, Counts>(&self.view, [x, y], key, 0, &self.sampler, counts);
        let mut radiance = self.estimator.sample::<S, X, Counts>(&self.scene, ray, key, &self.sampler, counts);
        if self.camera_rays > 1 {
            radiance +=
                extra_camera_rays(&self.scene, &self.view, [x, y], key, self.camera_rays, &self.sampler, counts);
        }
        radiance
    }
}

/// The kernel: sums of samples over pixels.
pub(super) struct Scalar<R> {
    samples: R,
    subpixel_limit: Option<f64>,
}

impl<R: Samples> Scalar<R> {
    /// The kernel of these samples.
    pub(super) fn new(samples: R, options: &RenderOptions) -> Self {
        let clamp = options.clamp.filter(|clamp| clamp.what == Clamped::Subpixel);
        Self { samples, subpixel_limit: clamp.map(|clamp: Clamp| clamp.limit) }
    }

    /// The contribution of a sample to its pixel.
    #[inline(always)]
    fn sample(&self, x: u32, y: u32, sample: u32, counts: &mut Counts) -> Rgb {
        let radiance = self.samples.radiance(x, y, sample, counts);
        counts.paths += 1;
        if radiance.is_valid_radiance() {
            return radiance;
        }
        counts.invalid += 1;
        Rgb::BLACK
    }

    /// Sums the samples of a pixel. If subpixels are clamped, each subpixel is one pass over its own samples, and its
    /// mean is cut at the limit before the four means are averaged; smallpt's limit is 1. Squares are taken of the
    /// unclamped samples. One loop serves both cases, because the compiler inlines a whole path at every call.
    fn pixel(&self, x: u32, y: u32, piece: &Piece, sum: &mut SampleSum, counts: &mut Counts) -> PixelSum {
        let passes = if self.subpixel_limit.is_some() { SUBPIXELS } else { 1 };
        let mut pixel = PixelSum::default();
        for pass in 0..passes {
            sum.clear();
            for sample in piece.samples.clone().filter(|sample| sample % passes == pass) {
                sum.add(self.sample(x, y, sample, counts));
            }
            let mut part = sum.total();
            let Some(limit) = self.subpixel_limit else { return part };
            part.sum = part.mean().map(|mean| mean.min(limit) * f64::from(part.count));
            pixel = pixel.plus(&part);
        }
        pixel
    }
}

impl<R: Samples> Kernel for Scalar<R> {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        let mut counts = Counts::default();
        let mut sum = SampleSum::default();
        for y in piece.bounds.y0..piece.bounds.y1 {
            for (x, pixel) in (piece.bounds.x0..piece.bounds.x1).zip(out.row_mut(y)) {
                *pixel = self.pixel(x, y, piece, &mut sum, &mut counts);
            }
        }
        counts
    }
}

/// One path at a time, in double precision.
pub const SCALAR: KernelEntry = KernelEntry::new("scalar", "one path at a time", plan);

/// The sampler that estimators and profiles are compiled for.
pub(super) const INDEPENDENT: &str = "independent";

fn plan(request: &Request<'_>) -> Result<Planned> {
    if request.precision != Precision::F64 {
        let problem = "is not supported by the scalar kernel";
        let error = InputError::new("precision", request.precision.name(), problem);
        return Err(error.allowed(Precision::F64.name()).into());
    }
    Ok(Planned::Ready(Arc::new(ScalarPlan)))
}

/// The plan of the scalar kernel, which renders everything.
pub(super) struct ScalarPlan;

impl KernelPlan for ScalarPlan {
    fn name(&self) -> &str {
        SCALAR.name
    }

    fn build(&self, scene: &Arc<Scene>, options: &RenderOptions) -> Result<Box<dyn Kernel>> {
        if let Some(Clamp { what: Clamped::Recursion, limit }) = options.clamp {
            return Ok(boxed(RecursionClamp { inspector: Inspector::new(scene, options)?, limit }, options));
        }
        let (name, scene) = (options.sampler.name, options.prepared(scene));
        let compiled = match options.profile.name {
            _ if options.custom.is_some() => None,
            profile if name == INDEPENDENT => with_profile(profile, ByProfile { scene: &scene, options }).flatten(),
            SmallptEffects::NAME => {
                keyed_sampler(name).and_then(|sampler| by_estimator::<_, SmallptEffects>(&scene, options, sampler))
            }
            _ => None,
        };
        if let Some(kernel) = compiled {
            return Ok(kernel);
        }
        let sampler = keyed_sampler(name).or_else(|| stateful_sampler(name, options.seed));
        let unknown = || unknown("sampler", name, SAMPLERS.iter().map(|entry| entry.name));
        Ok(boxed(Inspector::with(scene, options, sampler.ok_or_else(unknown)?)?, options))
    }

    fn first_hits(&self, scene: &Arc<Scene>, options: &RenderOptions, rays: Vec<Start>) -> Result<Box<dyn FirstHits>> {
        Ok(Box::new(ScalarSearch { scene: options.prepared(scene), rays }))
    }
}

fn boxed(samples: impl Samples + 'static, options: &RenderOptions) -> Box<dyn Kernel> {
    Box::new(Scalar::new(samples, options))
}

/// Maps the profile's name to a type, then the estimator's.
struct ByProfile<'a> {
    scene: &'a Arc<Scene>,
    options: &'a RenderOptions,
}

impl ProfileVisitor for ByProfile<'_> {
    type Output = Option<Box<dyn Kernel>>;
    fn visit<X: EffectSet>(self) -> Self::Output {
        by_estimator::<_, X>(self.scene, self.options, Independent)
    }
}

/// The kernel that is compiled for the profile and the sampler; `None` if the estimator is not compiled for the profile.
fn by_estimator<S: Sampler + 'static, X: EffectSet>(
    scene: &Arc<Scene>,
    options: &RenderOptions,
    sampler: S,
) -> Option<Box<dyn Kernel>> {
    let visitor = ByEstimator::<S, X> { scene: Arc::clone(scene), options, sampler, profile: PhantomData };
    with_estimator(options.estimator.name, options.options, visitor).flatten()
}

/// Whether scalar kernels of the estimator are compiled for the profile.
const fn is_compiled<E: Estimator, X: EffectSet>() -> bool {
    match E::COMPILED {
        CompiledFor::EveryProfile => true,
        CompiledFor::Common => X::EFFECTS.is(SmallptEffects::EFFECTS) || X::EFFECTS.is(AllEffects::EFFECTS),
        CompiledFor::WithAllEffects => X::EFFECTS.is(AllEffects::EFFECTS),
    }
}

/// Maps the estimator's name to a type, then to a kernel.
struct ByEstimator<'a, S, X> {
    scene: Arc<Scene>,
    options: &'a RenderOptions,
    sampler: S,
    profile: PhantomData<X>,
}

impl<S: Sampler + 'static, X: EffectSet> EstimatorVisitor for ByEstimator<'_, S, X> {
    type Output = Option<Box<dyn Kernel>>;
    fn visit<E: Estimator + 'static>(self, estimator: E) -> Self::Output {
        let Self { scene, options, sampler, .. } = self;
        // The condition is a constant, so a profile that is not compiled for takes no compile time.
        if const { is_compiled::<E, X>() } {
            Some(boxed(Compiled::<E, S, X>::new(scene, options, estimator, sampler), options))
        } else {
            None
        }
    }
}
