//! `--estimator smallpt`: the estimator of Kevin Beason's smallpt (2008), which report A took over.
//!
//! Glass is followed both ways at the first two vertices; roulette by the largest albedo channel starts after the fifth vertex; samples
//! go to 2x2 subpixels in turn, so their number must be a multiple of four (smallpt drops the rest without a word).

use super::{Estimator, Probe, path};
use crate::material::EffectSet;
use crate::math::{Ray, Rgb};
use crate::sampling::{SampleKey, Sampler};
use crate::scene::Scene;

/// The estimator.
#[derive(Debug, Clone, Copy, Default)]
pub struct Smallpt;

impl Estimator for Smallpt {
    const SPP_MULTIPLE: u32 = 4;

    #[inline(always)]
    fn sample<S: Sampler, X: EffectSet, P: Probe>(
        &self,
        scene: &Scene,
        ray: Ray,
        key: SampleKey,
        sampler: &S,
        probe: &mut P,
    ) -> Rgb {
        path::radiance::<2, S, X, P>(scene, ray, key, sampler, probe)
    }
}
