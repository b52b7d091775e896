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
pub(super) mod flips {
    /// Checks that `scramble`, like Owen's, flips each digit independently for every combination of the digits before
    /// it. Over a million keys the 63 flips of six digits must be even and pairwise uncorrelated. (Laine and Karras's
    /// own steps fail by a hundred standard deviations.)
    pub(in crate::sampling) fn are_independent(scramble: impl Fn(u64, u64) -> u64) {
        const LEVELS: u32 = 6;
        const NODES: usize = (1 << LEVELS) - 1;
        const KEYS: u64 = 1 << 20;
        let (mut single, mut double) = ([0_i64; NODES], vec![0_i64; NODES * NODES]);
        for key in 0..KEYS {
            let mut flips = [0_i64; NODES];
            for level in 0..LEVELS {
                for before in 0..1_u64 << level {
                    let flip = scramble(before, key) >> level & 1;
                    flips[(1 << level) - 1 + before as usize] = 2 * flip as i64 - 1;
                }
            }
            for (a, flip) in flips.iter().enumerate() {
                single[a] += flip;
                for (sum, other) in double[a * NODES..].iter_mut().zip(&flips[..a]) {
                    *sum += flip * other;
                }
            }
        }
        let pairs = (0..NODES).flat_map(|a| (0..a).map(move |b| a * NODES + b)).map(|index| double[index]);
        let sums: Vec<i64> = single.into_iter().chain(pairs).collect();
        // Two-sided, level 1e-3 for all 2016 sums together.
        let limit = 5.03;
        for (index, sum) in sums.iter().enumerate() {
            let z = *sum as f64 / (KEYS as f64).sqrt();
            assert!(z.abs() < limit, "sum {index} is {z} standard deviations from 0");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::independent::mix;
    use super::*;

    #[test]
    fn scrambling_flips_digits_independently() {
        super::flips::are_independent(|digits, key| scramble(digits, [mix(2 * key), mix(2 * key + 1)]));
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
