//! Samplers in SIMD lanes: numbers for several samples at once, the same bits as [`Sampler::pair`](super::Sampler::pair) gives for each.

use super::{Purpose, SampleKey, independent, mix, sobol};
use crate::math::Bits;
use crate::simd::Float;

/// A sampler that lanes can ask.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InLanes {
    /// `independent`.
    Independent,
    /// `sobol`.
    Sobol,
}

/// What the numbers of a sample have in common, worked out once for each.
#[derive(Debug, Clone, Copy, Default)]
pub struct PathWords<B = u64> {
    /// A mix of the seed, the pixel and, if it matters, the sample.
    pub path: B,
    /// The sample's index.
    pub sample: B,
    /// Its places in an order that the film and the first vertex share.
    pub joined: [B; 2],
}

impl InLanes {
    /// The sampler of that name; `None` if lanes cannot ask it.
    pub fn find(name: &str) -> Option<Self> {
        match name {
            "independent" => Some(Self::Independent),
            "sobol" => Some(Self::Sobol),
            _ => None,
        }
    }

    /// What a sample's numbers have in common.
    #[inline(always)]
    pub fn path(self, key: SampleKey) -> PathWords {
        let sample = u64::from(key.sample);
        match self {
            Self::Independent => PathWords { path: independent::path(key), sample, joined: [0; 2] },
            Self::Sobol => {
                let path = sobol::pixel(key);
                PathWords { path, sample, joined: sobol::joined(path, key.sample).map(u64::from) }
            }
        }
    }

    /// The pairs at vertex `bounce` of part `branch` of each path.
    #[inline(always)]
    pub fn pair<V: Float>(
        self,
        words: &PathWords<V::Bits>,
        bounce: V::Bits,
        branch: V::Bits,
        purpose: Purpose,
    ) -> [V; 2] {
        let dimension = bounce.up::<32>() | branch.up::<16>() | V::Bits::splat(purpose as u64);
        let key = mix(words.path ^ dimension);
        let [first, second] = match self {
            Self::Independent => independent::pcg32(key, dimension),
            Self::Sobol => {
                let place = match purpose {
                    // Nobody but the camera asks for it.
                    Purpose::Film => words.joined[0],
                    Purpose::Bsdf | Purpose::Light => {
                        let is_first = V::same(bounce.up::<16>() | branch, V::Bits::splat(1 << 16));
                        V::choose(is_first, words.joined[1], sobol::own_place(key, words.sample))
                    }
                    _ => sobol::own_place(key, words.sample),
                };
                sobol::fractions(key, place)
            }
        };
        [V::unit(first), V::unit(second)]
    }
}
