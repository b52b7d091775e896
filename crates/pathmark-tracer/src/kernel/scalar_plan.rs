//! The entry of the scalar kernel, and the choice of its compiled code.
//!
//! With the sampler `independent` the whole path is compiled as one function for each estimator and several effect
//! profiles. With other samplers the estimator and the sampler are called through pointers, with every effect: each
//! copy of the path takes a second to compile, and pointers cost these renders at most a fifth of their time
//! (docs/tried.md).

use super::clamp::{Clamp, Clamped};
use super::entry::{KernelEntry, Planned, Request};
use super::inspect::Inspector;
use super::options::{KernelPlan, RenderOptions, unknown};
use super::rays::{FirstHits, ScalarSearch, Start};
use super::recursion_clamp::RecursionClamp;
use super::render::Kernel;
use super::scalar::{Compiled, Samples, Scalar};
use crate::effect::EffectSet;
use crate::error::{InputError, Result};
use crate::estimator::{Compiled as CompiledFor, ESTIMATORS, Estimator, EstimatorVisitor, with_estimator};
use crate::math::Precision;
use crate::sampling::{Independent, SAMPLERS, keyed_sampler, stateful_sampler};
use crate::scene::{AllEffects, ProfileVisitor, Scene, SmallptEffects, with_profile};
use std::marker::PhantomData;
use std::sync::Arc;

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
        let name = options.sampler.name;
        if options.custom.is_some() || name != INDEPENDENT {
            let sampler = keyed_sampler(name).or_else(|| stateful_sampler(name, options.seed));
            let unknown = || unknown("sampler", name, SAMPLERS.iter().map(|entry| entry.name));
            return Ok(boxed(Inspector::with(scene, options, sampler.ok_or_else(unknown)?)?, options));
        }
        let scene = options.prepared(scene);
        let kernel = with_profile(options.profile.name, ByProfile { scene, options }).flatten();
        let unknown = || unknown("estimator", options.estimator.name, ESTIMATORS.iter().map(|entry| entry.name));
        Ok(kernel.ok_or_else(unknown)?)
    }

    fn first_hits(&self, scene: &Arc<Scene>, options: &RenderOptions, rays: Vec<Start>) -> Result<Box<dyn FirstHits>> {
        Ok(Box::new(ScalarSearch::new(options.prepared(scene), rays)))
    }
}

fn boxed(samples: impl Samples + 'static, options: &RenderOptions) -> Box<dyn Kernel> {
    Box::new(Scalar::new(samples, options))
}

/// Maps the profile's name to a type, then the estimator's.
struct ByProfile<'a> {
    scene: Arc<Scene>,
    options: &'a RenderOptions,
}

impl ProfileVisitor for ByProfile<'_> {
    type Output = Option<Box<dyn Kernel>>;
    fn visit<X: EffectSet>(self) -> Self::Output {
        let Self { scene, options } = self;
        let by_estimator = ByEstimator::<X> { scene, options, profile: PhantomData };
        with_estimator(options.estimator.name, options.options, by_estimator)
    }
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
struct ByEstimator<'a, X> {
    scene: Arc<Scene>,
    options: &'a RenderOptions,
    profile: PhantomData<X>,
}

impl<X: EffectSet> EstimatorVisitor for ByEstimator<'_, X> {
    type Output = Box<dyn Kernel>;
    fn visit<E: Estimator + 'static>(self, estimator: E) -> Self::Output {
        let Self { scene, options, .. } = self;
        // The condition is a constant, so a profile that is not compiled for takes no compile time. `choose` never asks
        // for one.
        if const { is_compiled::<E, X>() } {
            boxed(Compiled::<E, _, X>::new(scene, options, estimator, Independent), options)
        } else {
            boxed(Compiled::<E, _, AllEffects>::new(scene, options, estimator, Independent), options)
        }
    }
}
