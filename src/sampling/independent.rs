//! Independent uniform numbers: `--sampler independent`.
//!
//! Each address has a PCG32 generator of its own (O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms
//! for Random Number Generation", 2014; crate `rand_pcg`). Two PCGs are correlated when their states or streams differ in a simple way: by
//! 10 to 900 standard deviations with raw pixel numbers, and still by 10 to 100 when only the streams differ and the states are the
//! same well-mixed number. So everything goes into the state: a mix of (seed, pixel, sample) is mixed again with the dimension, which is
//! (bounce, branch, purpose) and also the stream.
//!
//! No two addresses of a seed share a generator, by construction. (pixel, sample) are the halves of one number, (bounce, branch, purpose)
//! lie beside each other in another, and nothing is cut off. [`mix`] is a bijection: an addition, multiplications by odd numbers and shifts
//! added to what was shifted can each be undone. What differs before a mix or before an exclusive or with the same number therefore differs
//! after it: at one dimension two samples have two states, and two dimensions have two streams. Two seeds may meet in a state, by a chance of
//! 2^-64 for each two samples.

use super::{Address, Sampler};
use rand::Rng;
use rand_pcg::Pcg32;

/// The sampler; it has no state.
#[derive(Debug, Clone, Copy, Default)]
pub struct Independent;

/// The finaliser of `SplitMix64` (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014, variant 13 of Stafford's
/// mixers), a bijection of 64-bit numbers; the offset keeps zero from being its own image.
#[inline(always)]
pub fn mix(x: u64) -> u64 {
    let mut z = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The top 53 bits as a multiple of 2^-53 in [0, 1): exact, and never 1.
#[inline(always)]
pub fn unit(bits: u64) -> f64 {
    const STEP: f64 = 1.0 / 9_007_199_254_740_992.0;
    (bits >> 11) as f64 * STEP
}

impl Sampler for Independent {
    #[inline(always)]
    fn pair(&self, at: Address) -> [f64; 2] {
        let place = u64::from(at.key.pixel) << 32 | u64::from(at.key.sample);
        let dimension = u64::from(at.bounce) << 32 | u64::from(at.branch) << 16 | at.purpose as u64;
        // The same for a whole path, so a compiler takes it out of the loop over bounces.
        let path = mix(mix(place) ^ mix(at.key.seed));
        let mut pcg = Pcg32::new(mix(path ^ dimension), dimension);
        [unit(pcg.next_u64()), unit(pcg.next_u64())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The reference stream of the PCG C library's demo, so that the crate is the generator that we say it is.
    #[test]
    fn pcg32_is_oneills() {
        let mut pcg = Pcg32::new(42, 54);
        assert_eq!([pcg.next_u32(), pcg.next_u32(), pcg.next_u32()], [0xa15c_02b7, 0x7b47_f409, 0xba1d_3330]);
    }
}
