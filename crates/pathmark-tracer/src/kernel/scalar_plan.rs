//! The entry of the scalar kernel, and the choice of its compiled code.
//!
//! With the sampler `independent` the whole path is compiled as one function for each estimator and several effect
//! profiles. Other samplers are called through pointers: in scenes of smallpt's effects by compiled estimators, in other
//! scenes by estimators that are pointers, too. Each copy of the path takes a second to compile, and pointers cost these
//! renders up to a fifth of their time (docs/tried.md).

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
use crate::estimator::{Compiled as CompiledFor, Estimator, EstimatorVisitor, with_estimator};
use crate::math::Precision;
use crate::sampling::{Independent, SAMPLERS, Sampler, keyed_sampler, stateful_sampler};
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
        Ok(Box::new(ScalarSearch::new(options.prepared(scene), rays)))
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
