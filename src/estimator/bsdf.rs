//! `--estimator bsdf`: one direction at every vertex, chosen by the surface; smallpt's transport without its splitting.

use super::{Estimator, Probe, path};
use crate::material::EffectSet;
use crate::math::{Ray, Rgb};
use crate::sampling::{SampleKey, Sampler};
use crate::scene::Scene;

/// The estimator.
#[derive(Debug, Clone, Copy, Default)]
pub struct Bsdf;

impl Estimator for Bsdf {
    const SPP_MULTIPLE: u32 = 1;

    #[inline(always)]
    fn sample<S: Sampler, X: EffectSet, P: Probe>(
        &self,
        scene: &Scene,
        ray: Ray,
        key: SampleKey,
        sampler: &S,
        probe: &mut P,
    ) -> Rgb {
        path::radiance::<0, S, X, P>(scene, ray, key, sampler, probe)
    }
}
