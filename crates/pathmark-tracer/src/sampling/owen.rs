//! Owen's scrambling of binary digits, by integer arithmetic (A. B. Owen, "Randomly permuted (t,m,s)-nets and
//! (t,s)-sequences", 1995).

use crate::math::Bits;

/// Scrambles binary digits, the first in the lowest bit. The keys and the digits before a digit decide whether it is
/// flipped. Zeros beyond the last digit become random digits.
///
/// The idea is due to S. Laine and T. Karras, "Stratified Sampling for Stochastic Transparency", 2011: sums and
/// products carry only upwards. Their steps flip some digits together that should be independent, so this function uses
/// other steps, all of them keyed.
#[inline(always)]
pub(super) fn scramble<B: Bits>(digits: B, [a, b]: [B; 2]) -> B {
    let digits = digits ^ digits.times(b.up::<1>());
    let digits = digits.plus(a).times(b.up::<32>() | b.down::<32>() | B::splat(1));
    let digits = digits ^ digits.times((a.up::<32>() | a.down::<32>()).up::<1>());
    digits.plus(b.up::<16>() | b.down::<48>())
}

/// Permutes the numbers 0..2^32: each aligned block of 2^k numbers stays together and moves to an aligned place.
#[inline(always)]
pub(super) fn shuffle<B: Bits>(index: B, keys: [B; 2]) -> B {
    scramble(index.reversed().down::<32>(), keys).up::<32>().reversed()
}

#[cfg(test)]
mod tests {
    use super::super::independent::mix;
    use super::*;

    #[test]
    fn scrambling_flips_digits_independently() {
        crate::sampling::tests::flips_are_independent(|digits, key| scramble(digits, [mix(2 * key), mix(2 * key + 1)]));
    }

    /// A digit's flip depends on the digits before it and on none after it, so a scrambled net is a net.
    #[test]
    fn scrambling_keeps_shared_leading_digits() {
        for key in 0..1000 {
            let keys = [mix(key), mix(key ^ 1 << 32)];
            for level in 0..64 {
                let (one, other) = (mix(key + 1), mix(key + 2));
                let shared = (1_u64 << level) - 1;
                let joined = one & shared | other & !shared;
                assert_eq!((scramble(one, keys) ^ scramble(joined, keys)) & shared, 0, "key {key}, {level} digits");
            }
            assert_ne!(scramble(key, keys), scramble(key ^ 1 << 63, keys));
        }
    }

    /// A shuffle of 2^12 numbers keeps all aligned blocks together.
    #[test]
    fn shuffling_keeps_blocks() {
        for key in 0..100 {
            let all: Vec<u64> = (0..1 << 12).map(|index| shuffle(index, [mix(key), mix(!key)])).collect();
            for level in 0..=12 {
                for block in all.chunks(1 << level) {
                    let first = block[0] >> level;
                    assert!(block.iter().all(|index| index >> level == first), "key {key}, blocks of 2^{level}");
                }
            }
            let mut sorted = all;
            sorted.sort_unstable();
            assert!(sorted.windows(2).all(|two| two[1] == two[0] + 1), "key {key}");
        }
    }
}
