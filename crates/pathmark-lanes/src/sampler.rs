//! Samplers in SIMD lanes: random numbers for several samples at once, with the same bits as
//! [`Sampler::pair`](pathmark_tracer::sampling::Sampler::pair).

use crate::simd::{Apart, Float, Words};
use pathmark_tracer::math::Bits;
use pathmark_tracer::sampling::{Purpose, SampleKey, hash, independent, mix, sobol};

/// A sampler that is available in lanes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InLanes {
    Independent,
    Hash,
    Sobol,
}

/// The values that all random numbers of a sample share, computed once per sample.
#[derive(Debug, Clone, Copy, Default)]
pub struct PathWords<B> {
    /// A mix of the seed, the pixel and, if it matters, the sample.
    pub path: B,
    /// The sample's index, or its digits as the sampler needs them.
    pub sample: B,
    /// Its positions in the order that the film and the first vertex share.
    pub joined: [B; 2],
}

impl InLanes {
    /// The sampler of that name; `None` if it is not available in lanes.
    pub fn find(name: &str) -> Option<Self> {
        match name {
            "independent" => Some(Self::Independent),
            "hash" => Some(Self::Hash),
            "sobol" => Some(Self::Sobol),
            _ => None,
        }
    }

    /// Whether a number depends on more of its sample than [`PathWords::path`] contains.
    #[inline(always)]
    pub fn is_spread(self) -> bool {
        self == Self::Sobol
    }

    /// The positions of a sample in the order that the film and the first vertex share; 0 if the sampler has none.
    #[inline(always)]
    pub fn joined(self, key: SampleKey) -> [u64; 2] {
        match self {
            Self::Independent | Self::Hash => [0; 2],
            Self::Sobol => sobol::joined(sobol::pixel(key.seed, u64::from(key.pixel)), key.sample).map(u64::from),
        }
    }

    /// Computes the values that all random numbers of each sample share.
    #[inline(always)]
    pub fn words<B: Bits>(self, seed: u64, pixel: B, sample: B, joined: [B; 2]) -> PathWords<B> {
        let path = match self {
            Self::Independent | Self::Hash => independent::path(seed, pixel.up::<32>() | sample),
            Self::Sobol => sobol::pixel(seed, pixel),
        };
        let sample = if self == Self::Sobol { sobol::digits(sample) } else { sample };
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
            Self::Sobol => return V::apart(Scrambled { key, words, bounce, branch, purpose }),
        };
        [V::unit(first), V::unit(second)]
    }
}

/// A pair of `sobol`. It takes so many operations that a function call costs little beside them.
struct Scrambled<'a, V: Float> {
    /// A mix of everything but the sample's index.
    key: V::Bits,
    words: &'a PathWords<V::Bits>,
    bounce: V::Bits,
    branch: V::Bits,
    purpose: Purpose,
}

impl<V: Float> Scrambled<'_, V> {
    #[inline(always)]
    fn own_place(&self) -> V::Bits {
        sobol::own_place(self.key, self.words.sample)
    }
}

impl<V: Float> Apart for Scrambled<'_, V> {
    type Output = [V; 2];

    #[inline(always)]
    fn run(self) -> [V; 2] {
        let Self { key, words, bounce, branch, purpose } = &self;
        let place = match purpose {
            // Only the camera uses this purpose.
            Purpose::Film => words.joined[0],
            Purpose::Bsdf | Purpose::Light => {
                let is_first = (bounce.up::<16>() | *branch).equal(V::Bits::splat(1 << 16));
                V::Bits::choose(is_first, words.joined[1], self.own_place())
            }
            _ => self.own_place(),
        };
        let [first, second] = sobol::fractions(*key, place);
        [V::unit(first), V::unit(second)]
    }
}
