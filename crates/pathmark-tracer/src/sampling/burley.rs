//! Owen's scrambling of 32 binary digits by four products of 32 bits.
//!
//! The method is that of B. Burley ("Practical Hash-based Owen Scrambling", Journal of Computer Graphics Techniques 9(4),
//! 2020). The hash is of the family of S. Laine and T. Karras ("Stratified Sampling for Stochastic Transparency", 2011)
//! with the constants of N. Vegdahl ("Building a Better LK Hash", 2021). Digits beyond the 32nd do not belong to the
//! net. The first 32 come from the lower halves of words alone, so single precision computes them in words of 32 bits.

use crate::math::Bits;

/// Scrambles 32 binary digits, the first in the lowest bit. The upper half of the result is meaningless.
#[inline(always)]
pub(super) fn scramble<B: Bits>(digits: B, seed: Seed<B>) -> B {
    with_seed(without_seed(digits), seed)
}

/// A seed and the same seed shifted down by 16 bits, of which words of 32 bits know only the lower halves.
pub(super) type Seed<B> = [B; 2];

/// The first step, which no seed affects.
#[inline(always)]
fn without_seed<B: Bits>(digits: B) -> B {
    digits ^ digits.times_low(B::splat(0x3D20_ADEA))
}

/// The other steps. They ignore the upper half of `digits`.
#[inline(always)]
fn with_seed<B: Bits>(digits: B, [seed, upper]: Seed<B>) -> B {
    let digits = digits.plus(seed).times_low(upper | B::splat(1));
    let digits = digits ^ digits.times_low(B::splat(0x0552_6C56));
    digits ^ digits.times_low(B::splat(0x53A2_2864))
}

/// A sample's index for shuffling, in 32 bits: its first digit is in the lowest bit, and it is scrambled as far as no seed
/// affects it. It is constant along a path.
#[inline(always)]
pub fn digits<B: Bits>(sample: B) -> B {
    without_seed(sample.mirrored()) & B::splat(u64::from(u32::MAX))
}

/// Permutes the numbers 0..2^32, given by their [`digits`]: each aligned block of 2^k numbers stays together and moves to
/// an aligned place. The upper half of `digits` is ignored.
#[inline(always)]
pub(super) fn shuffle<B: Bits>(digits: B, seed: Seed<B>) -> B {
    with_seed(digits, seed).mirrored()
}

#[cfg(test)]
mod tests {
    use super::super::independent::mix;
    use super::*;
    use crate::sampling::tests::flips_are_independent;

    fn of(seed: u64) -> Seed<u64> {
        [seed, seed >> 16]
    }

    /// Checks the constants and their order against Vegdahl's own form of the hash, on 32-bit words.
    #[test]
    fn it_is_vegdahls_hash() {
        let hash = |mut x: u32, seed: u32| {
            x ^= x.wrapping_mul(0x3d20_adea);
            x = x.wrapping_add(seed);
            x = x.wrapping_mul((seed >> 16) | 1);
            x ^= x.wrapping_mul(0x0552_6c56);
            x ^ x.wrapping_mul(0x53a2_2864)
        };
        for k in 0..1000 {
            let (digits, seed) = (mix(k) as u32, mix(!k) as u32);
            let of_words = scramble(u64::from(digits), of(u64::from(seed)));
            assert_eq!(of_words as u32, hash(digits, seed));
        }
    }

    #[test]
    fn scrambling_flips_digits_independently() {
        flips_are_independent(|digits, key| scramble(digits, of(mix(key))));
        flips_are_independent(|digits, key| scramble(digits, of(mix(key) >> 32)));
    }

    /// A digit's flip depends on the digits before it and on none after it, so a scrambled net is a net.
    #[test]
    fn scrambling_keeps_shared_leading_digits() {
        for key in 0..1000 {
            for level in 0..32 {
                let (one, other) = (mix(key + 1), mix(key + 2));
                let shared = (1_u64 << level) - 1;
                let joined = one & shared | other & !shared;
                let seed = of(mix(key));
                assert_eq!((scramble(one, seed) ^ scramble(joined, seed)) & shared, 0, "key {key}, {level} digits");
            }
        }
    }
}
