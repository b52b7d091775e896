//! Samplers in SIMD lanes: random numbers for several samples at once, with the same bits as
//! [`Sampler::pair`](pathmark_tracer::sampling::Sampler::pair).

use crate::simd::{Apart, Float, Words};
use pathmark_tracer::math::Bits;
use pathmark_tracer::sampling::{Purpose, hash, independent, mix, sobol};

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
    /// Only for [`InLanes::is_spread`]: the sample's digits, and in the upper half its position in the order that the film
    /// and the first vertex share.
    pub sample: B,
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

    /// Computes the values that all random numbers of each sample share: those on the film, and those at the vertices.
    #[inline(always)]
    pub fn words<B: Bits>(self, seed: u64, pixel: B, sample: B) -> [PathWords<B>; 2] {
        if self != Self::Sobol {
            let words = PathWords { path: independent::path(seed, pixel.up::<32>() | sample), sample: B::splat(0) };
            return [words; 2];
        }
        let path = sobol::pixel(seed, pixel);
        let ([film, first], digits) = (sobol::joined(path, sample), sobol::digits(sample));
        [PathWords { path, sample: digits | film.up::<32>() }, PathWords { path, sample: digits | first.up::<32>() }]
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
        self.draw(words, bounce, branch, purpose, false)
    }

    /// The first number of each pair.
    #[inline(always)]
    pub fn number<V: Float>(self, words: &PathWords<V::Bits>, bounce: V::Bits, branch: V::Bits, purpose: Purpose) -> V {
        let [first, _] = self.draw(words, bounce, branch, purpose, true);
        first
    }

    /// The pairs; `sobol` does not compute their second numbers if `is_single`.
    #[inline(always)]
    fn draw<V: Float>(
        self,
        words: &PathWords<V::Bits>,
        bounce: V::Bits,
        branch: V::Bits,
        purpose: Purpose,
        is_single: bool,
    ) -> [V; 2] {
        let dimension = bounce.up::<32>() | branch.up::<16>() | V::Bits::splat(purpose as u64);
        if self == Self::Sobol {
            return V::apart(Scrambled { words, dimension, purpose, is_single });
        }
        let key = mix(words.path ^ dimension);
        let [first, second] = if self == Self::Hash { hash::both(key) } else { independent::pcg32(key, dimension) };
        [V::unit(first), V::unit(second)]
    }
}

/// A pair of `sobol`. It takes so many operations that a function call costs little beside them.
struct Scrambled<'a, V: Float> {
    words: &'a PathWords<V::Bits>,
    dimension: V::Bits,
    purpose: Purpose,
    /// Whether the first number is enough.
    is_single: bool,
}

impl<V: Float> Apart for Scrambled<'_, V> {
    type Output = [V; 2];

    #[inline(always)]
    fn run(self) -> [V; 2] {
        let Self { words, dimension, purpose, is_single } = self;
        let key = mix(words.path ^ dimension);
        let [digits, joined] = V::halves(words.sample);
        let mut place = joined;
        // Only the camera uses this purpose.
        if purpose != Purpose::Film {
            let own = sobol::own_place(seed::<V>(sobol::order(key)), digits);
            place = if matches!(purpose, Purpose::Bsdf | Purpose::Light) {
                let is_first = dimension.equal(V::Bits::splat(1 << 32 | purpose as u64));
                V::choose_digits(is_first, joined, own)
            } else {
                own
            };
        }
        let first = V::fraction(sobol::first(place, seed::<V>(key)));
        if is_single {
            return [first; 2];
        }
        let [_, upper] = V::halves(key);
        [first, V::fraction(sobol::second(place, [upper, upper.down::<16>()]))]
    }
}

/// The lower halves of words as seeds.
#[inline(always)]
fn seed<V: Float>(words: V::Bits) -> [V::Digits; 2] {
    let ([lower, _], [shifted, _]) = (V::halves(words), V::halves(words.down::<16>()));
    [lower, shifted]
}
