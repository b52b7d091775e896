//! Keys: no key is zero, no two addresses share one: R05, R06.

use super::unguarded::{fmix64, key_of_32_bits, wang_hash, xorshift32};
use super::{first, keyed};
use crate::Trials;
use crate::analysis::randomness::{repeated, repeated_words};
use crate::measure::LARGEST_SEED;
use crate::sampling::{Address, Purpose, REFERENCE_SEEDS, SampleKey, Sampler, mix};

/// Seeds at the ends of integer ranges.
const SEEDS: [u64; 6] = [0, 1, 1 << 31, (1 << 32) - 1, 1 << 63, u64::MAX];

/// Wang's hash of pixel 61 is 0, and xorshift with state 0 returns zeros for ever. The finaliser of Murmur's hash maps
/// 0 to 0. With the program's samplers no pixel starts with four zeros, whatever the seed.
pub(super) fn zeros(trials: &mut Trials) {
    trials.same("Wang's hash of 61", &0, &wang_hash(61));
    let mut state = wang_hash(61);
    trials.same(
        "xorshift of it, 1000 draws that are not 0",
        &0,
        &(0..1000).filter(|_| xorshift32(&mut state) != 0).count(),
    );
    trials.same("Murmur's finaliser of 0", &0, &fmix64(0));
    trials.holds("our mix of 0", "not 0", mix(0), mix(0) != 0);
    let (pixels, step) = (trials.times(786_432, 8_294_400) as u32, trials.times(12, 1) as u32);
    for (name, sampler) in keyed() {
        let mut zeros = 0;
        for seed in SEEDS {
            for pixel in (0..pixels).step_by(step as usize) {
                // The second pair is drawn only if the first is all zeros.
                let is_zero = |bounce| first(&*sampler, seed, pixel, 0, (bounce, Purpose::Bsdf)) == [0.0, 0.0];
                zeros += u64::from(is_zero(1) && is_zero(2));
            }
        }
        trials.never(name, "pixels that start with zeros", zeros, u64::from(pixels / step) * SEEDS.len() as u64);
    }
}

/// The inverse of `mix`: undoes each of its steps. An inverse for every number shows that no two numbers share an
/// image.
fn unmix(x: u64) -> u64 {
    // A shift is undone by repeating it on the bits known so far.
    let unshift = |x: u64, by: u32| (0..64 / by).fold(x, |known, _| x ^ (known >> by));
    let z = unshift(x, 31).wrapping_mul(inverse(0x94D0_49BB_1331_11EB));
    let z = unshift(z, 27).wrapping_mul(inverse(0xBF58_476D_1CE4_E5B9));
    unshift(z, 30).wrapping_sub(0x9E37_79B9_7F4A_7C15)
}

/// The inverse of an odd number modulo 2^64, by Newton's iteration: each step doubles the number of correct bits.
fn inverse(odd: u64) -> u64 {
    (0..6).fold(odd, |x, _| x.wrapping_mul(2_u64.wrapping_sub(odd.wrapping_mul(x))))
}

fn bijection(trials: &mut Trials) {
    let ends = [0, 1, u64::MAX, u64::MAX - 1, 1 << 63, (1 << 63) - 1, 0x9E37_79B9_7F4A_7C15, 0x61C8_8646_80B5_83EB];
    let single = (0..64).map(|bit| 1_u64 << bit);
    let n = trials.times(100_000, 100_000_000);
    let many = (0..n).flat_map(|k| [k, !k, k.wrapping_mul(0xD134_2543_DE82_EF95)]);
    let (mut wrong, mut tried) = (0, 0);
    for x in ends.into_iter().chain(single).chain(many) {
        tried += 1;
        wrong += u64::from(unmix(mix(x)) != x || mix(unmix(x)) != x);
    }
    trials.never("mix", "numbers that do not come back", wrong, tried);
}

/// The 106 bits of a pair.
fn bits([u, v]: [f64; 2]) -> u128 {
    u128::from(u.to_bits()) << 64 | u128::from(v.to_bits())
}

/// Exhaustive: every pixel and sample of an image, every use along a path with its branches, and two images of a seed
/// and of a reference seed. By chance, one in 1e16 such sets contains a pair twice. With 32-bit keys, 72 pairs of
/// pixels of such an image share a key.
pub(super) fn collisions(trials: &mut Trials) {
    bijection(trials);
    let pairs = repeated_words((0..786_432).map(key_of_32_bits).collect());
    // 786432²/2/2^32, with a tolerance of five times its square root.
    trials.close("keys of 32 bits: pairs that share one", 72.0, pairs as f64, 5.0 * 72.0_f64.sqrt());
    trials.same("every seed is an image's or a reference's", &REFERENCE_SEEDS, &(LARGEST_SEED + 1));
    let spp = trials.times(4, 8) as u32;
    let bounces = trials.times(1 << 12, 1 << 16);
    for (name, sampler) in keyed() {
        let pair = |seed, pixel, sample| bits(first(&*sampler, seed, pixel, sample, (0, Purpose::Film)));
        let (whole, others) = (trials.times(65_536, 786_432) as u32, trials.times(1 << 14, 786_432) as u32);
        for (seed, reference, pixels) in
            [(1, REFERENCE_SEEDS | 1, whole), (0, REFERENCE_SEEDS, others), (LARGEST_SEED, u64::MAX, others)]
        {
            let places = || (0..pixels).flat_map(|pixel| (0..spp).map(move |sample| (pixel, sample)));
            let mut all: Vec<u128> = places().map(|(pixel, sample)| pair(seed, pixel, sample)).collect();
            all.extend(places().map(|(pixel, sample)| pair(reference, pixel, sample)));
            let n = all.len() as u64;
            trials.never(
                format!("{name}, images of seed {seed} and of reference {reference}"),
                "pairs twice",
                repeated(all),
                n,
            );
        }
        let all = along_a_path(&*sampler, bounces);
        let n = all.len() as u64;
        trials.never(format!("{name}, uses along a path"), "pairs twice", repeated(all), n);
    }
}

fn along_a_path(sampler: &dyn Sampler, bounces: u64) -> Vec<u128> {
    let mut all = Vec::new();
    for bounce in 0..=(bounces - 1) as u16 {
        for branch in [0, 1, 2, 3, 255, u16::MAX] {
            for purpose in Purpose::ALL {
                // All parts of the key at their largest values.
                let key = SampleKey { seed: u64::MAX, pixel: u32::MAX, sample: u32::MAX };
                all.push(bits(sampler.pair(Address { key, bounce, branch, purpose })));
            }
        }
    }
    all
}
