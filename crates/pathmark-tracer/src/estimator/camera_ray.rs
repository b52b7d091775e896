//! Where a path begins.

use super::Probe;
use crate::effect::EffectSet;
use crate::math::Ray;
use crate::sampling::{Address, Purpose, SampleKey, Sampler};
use crate::scene::{LENS, View};

/// The ray of a sample through the pixel in column `x` of row `y`, whose index is in the key.
#[inline(always)]
pub fn camera_ray<S: Sampler, X: EffectSet, P: Probe>(
    view: &View,
    [x, y]: [u32; 2],
    key: SampleKey,
    sampler: &S,
    probe: &mut P,
) -> Ray {
    let pair = |purpose| sampler.pair(Address { key, bounce: 0, branch: 0, purpose });
    view.ray::<X>(x, y, key.sample, pair(Purpose::Film), || {
        probe.used(LENS);
        pair(Purpose::Lens)
    })
}
