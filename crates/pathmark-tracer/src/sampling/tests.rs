//! A check that tests of several samplers share.

/// Checks that `scramble`, like Owen's, flips each digit independently for every combination of the digits before
/// it. Over a million keys the 63 flips of six digits must be even and pairwise uncorrelated. (Laine and Karras's
/// own steps fail by a hundred standard deviations.)
pub(super) fn flips_are_independent(scramble: impl Fn(u64, u64) -> u64) {
    const LEVELS: u32 = 6;
    const NODES: usize = (1 << LEVELS) - 1;
    const KEYS: u64 = 1 << 20;
    let (mut single, mut double) = ([0_i64; NODES], vec![0_i64; NODES * NODES]);
    // A flip counts as 1, none as -1. A word has the flips of 64 keys at a node.
    let sum = |flips: u64| 2 * i64::from(flips.count_ones()) - 64;
    for first in (0..KEYS).step_by(64) {
        let mut flips = [0_u64; NODES];
        for key in first..first + 64 {
            for level in 0..LEVELS {
                for before in 0..1_u64 << level {
                    let flip = scramble(before, key) >> level & 1;
                    flips[(1 << level) - 1 + before as usize] |= flip << (key - first);
                }
            }
        }
        for (a, flip) in flips.iter().enumerate() {
            single[a] += sum(*flip);
            for (total, other) in double[a * NODES..].iter_mut().zip(&flips[..a]) {
                *total += sum(!(flip ^ other));
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
