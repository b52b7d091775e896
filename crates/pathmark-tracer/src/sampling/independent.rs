//! Independent uniform numbers: `--sampler independent`.
//!
//! Each address has its own PCG32 generator (O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good
//! Algorithms for Random Number Generation", 2014; crate `rand_pcg`). Two PCGs are correlated if their states or
//! streams differ in a simple way: by 10 to 900 standard deviations with raw pixel indices, and still by 10 to 100 if
//! only the streams differ and both states are the same well-mixed number. So the whole address determines the state: a
//! mix of (seed, pixel, sample) is mixed again with the dimension, which is (bounce, branch, purpose) and also the
//! stream.
//!
//! No two addresses of a seed share a generator, by construction. (pixel, sample) are the halves of one number,
//! (bounce, branch, purpose) lie beside each other in another, and no bit is cut off. [`mix`] is a bijection: the
//! addition, the multiplications by odd numbers and the exclusive ors with a shifted copy can each be undone. So values
//! that differ before a mix, or before an exclusive or with the same number, differ after it. At one dimension two
//! samples have two states, and two dimensions have two streams. Two seeds may share a state, with probability 2^-64
//! for each pair of samples.

use super::{Address, Sampler};
use crate::math::{Bits, unit};
use rand::Rng;
use rand_pcg::Pcg32;

/// The sampler; it has no state.
#[derive(Debug, Clone, Copy, Default)]
pub struct Independent;

/// The finaliser of `SplitMix64` (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014,
/// variant 13 of Stafford's mixers): a bijection of 64-bit numbers. The offset ensures that zero is not mapped to
/// itself.
#[inline(always)]
pub fn mix<B: Bits>(x: B) -> B {
    let z = x.plus(B::splat(0x9E37_79B9_7F4A_7C15));
    let z = (z ^ z.down::<30>()).times(B::splat(0xBF58_476D_1CE4_E5B9));
    let z = (z ^ z.down::<27>()).times(B::splat(0x94D0_49BB_1331_11EB));
    z ^ z.down::<31>()
}

/// The hash of seed, pixel and sample that all addresses of a sample share.
#[inline(always)]
pub fn path<B: Bits>(seed: u64, place: B) -> B {
    mix(mix(place) ^ B::splat(mix(seed)))
}

/// The 32-bit output of a PCG32 in this state.
#[inline(always)]
fn output<B: Bits>(state: B) -> B {
    let low = B::splat(u64::from(u32::MAX));
    let x = (state.down::<18>() ^ state).down::<27>() & low;
    // The word is doubled side by side, so that a shift gives the rotation.
    (x | x.up::<32>()).down_by(state.down::<59>()) & low
}

/// The first two 64-bit numbers of a PCG32 with this state and stream, as `rand_pcg` returns them, in every lane. (No
/// closures: the compiler may leave them outside the function that enables the SIMD instructions.)
#[inline(always)]
pub fn pcg32<B: Bits>(state: B, stream: B) -> [B; 2] {
    let multiplier = B::splat(0x5851_F42D_4C95_7F2D);
    let increment = stream.up::<1>() | B::splat(1);
    let first = state.plus(increment).times(multiplier).plus(increment);
    let second = first.times(multiplier).plus(increment);
    let third = second.times(multiplier).plus(increment);
    let fourth = third.times(multiplier).plus(increment);
    [output(first) | output(second).up::<32>(), output(third) | output(fourth).up::<32>()]
}

impl Sampler for Independent {
    #[inline(always)]
    fn pair(&self, at: Address) -> [f64; 2] {
        let dimension = u64::from(at.bounce) << 32 | u64::from(at.branch) << 16 | at.purpose as u64;
        // Constant along a path, so the compiler moves it out of the loop over bounces.
        let path = path(at.key.seed, u64::from(at.key.pixel) << 32 | u64::from(at.key.sample));
        let mut pcg = Pcg32::new(mix(path ^ dimension), dimension);
        [unit(pcg.next_u64()), unit(pcg.next_u64())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The reference stream of the PCG C library's demo: it confirms that the crate's generator is PCG32.
    #[test]
    fn pcg32_is_oneills() {
        let mut pcg = Pcg32::new(42, 54);
        assert_eq!([pcg.next_u32(), pcg.next_u32(), pcg.next_u32()], [0xa15c_02b7, 0x7b47_f409, 0xba1d_3330]);
    }

    /// Lanes return the crate's numbers.
    #[test]
    fn pcg32_of_lanes_is_the_crates() {
        for k in 0..10_000_u64 {
            let (state, stream) = (mix(2 * k), mix(2 * k + 1));
            let mut pcg = Pcg32::new(state, stream);
            assert_eq!(pcg32(state, stream), [pcg.next_u64(), pcg.next_u64()]);
        }
    }
}
