//! Samplers in SIMD lanes: numbers for several samples at once, the same bits as [`Sampler::pair`](super::Sampler::pair) gives for each.

use super::{Purpose, SampleKey, hash, independent, mix, sobol, sobol_burley};
use crate::math::Bits;
use crate::simd::{Apart, Float, Words};

/// A sampler that lanes can ask.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InLanes {
    /// `independent`.
    Independent,
    /// `hash`.
    Hash,
    /// `sobol`.
    Sobol,
    /// `sobol-burley`.
    SobolBurley,
}

/// What the numbers of a sample have in common, worked out once for each.
#[derive(Debug, Clone, Copy, Default)]
pub struct PathWords<B> {
    /// A mix of the seed, the pixel and, if it matters, the sample.
    pub path: B,
    /// The sample's index, or what the sampler makes of it.
    pub sample: B,
    /// Its places in an order that the film and the first vertex share.
    pub joined: [B; 2],
}

impl InLanes {
    /// The sampler of that name; `None` if lanes cannot ask it.
    pub fn find(name: &str) -> Option<Self> {
        match name {
            "independent" => Some(Self::Independent),
            "hash" => Some(Self::Hash),
            "sobol" => Some(Self::Sobol),
            "sobol-burley" => Some(Self::SobolBurley),
            _ => None,
        }
    }

    /// Whether a number depends on more of its sample than [`PathWords::path`] tells.
    #[inline(always)]
    pub fn is_spread(self) -> bool {
        matches!(self, Self::Sobol | Self::SobolBurley)
    }

    /// The places of a sample that the film and the first vertex share; 0 if there are none.
    #[inline(always)]
    pub fn joined(self, key: SampleKey) -> [u64; 2] {
        match self {
            Self::Independent | Self::Hash => [0; 2],
            Self::Sobol | Self::SobolBurley => {
                sobol::joined(sobol::pixel(key.seed, u64::from(key.pixel)), key.sample).map(u64::from)
            }
        }
    }

    /// What the numbers of samples of some pixels have in common.
    #[inline(always)]
    pub fn words<B: Bits>(self, seed: u64, pixel: B, sample: B, joined: [B; 2]) -> PathWords<B> {
        let path = match self {
            Self::Independent | Self::Hash => independent::path(seed, pixel.up::<32>() | sample),
            Self::Sobol | Self::SobolBurley => sobol::pixel(seed, pixel),
        };
        let sample = if self == Self::SobolBurley { sobol_burley::digits(sample) } else { sample };
        PathWords { path, sample, joined }
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
            Self::Hash => hash::both(key),
            Self::Sobol => return V::apart(Scrambled::<V, false> { key, words, bounce, branch, purpose }),
            Self::SobolBurley => return V::apart(Scrambled::<V, true> { key, words, bounce, branch, purpose }),
        };
        [V::unit(first), V::unit(second)]
    }
}

/// A pair of `sobol` or `sobol-burley`, by so many operations that a call is nothing beside them.
struct Scrambled<'a, V: Float, const BURLEY: bool> {
    /// A mix of everything.
    key: V::Bits,
    words: &'a PathWords<V::Bits>,
    bounce: V::Bits,
    branch: V::Bits,
    purpose: Purpose,
}

impl<V: Float, const BURLEY: bool> Scrambled<'_, V, BURLEY> {
    #[inline(always)]
    fn own_place(&self) -> V::Bits {
        let sample = self.words.sample;
        if BURLEY { sobol_burley::own_place(self.key, sample) } else { sobol::own_place(self.key, sample) }
    }
}

impl<V: Float, const BURLEY: bool> Apart for Scrambled<'_, V, BURLEY> {
    type Output = [V; 2];

    #[inline(always)]
    fn run(self) -> [V; 2] {
        let Self { key, words, bounce, branch, purpose } = &self;
        let place = match purpose {
            // Nobody but the camera asks for it.
            Purpose::Film => words.joined[0],
            Purpose::Bsdf | Purpose::Light => {
                let is_first = (bounce.up::<16>() | *branch).equal(V::Bits::splat(1 << 16));
                V::Bits::choose(is_first, words.joined[1], self.own_place())
            }
            _ => self.own_place(),
        };
        let [first, second] = if BURLEY { sobol_burley::fractions(*key, place) } else { sobol::fractions(*key, place) };
        [V::unit(first), V::unit(second)]
    }
}
