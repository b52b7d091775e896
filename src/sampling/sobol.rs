//! Owen-scrambled Sobol pairs: `--sampler sobol`.
//!
//! A pair of numbers belongs to the first two dimensions of Sobol's sequence (I. M. Sobol', "On the distribution of points in a cube and
//! the approximate evaluation of integrals", USSR Computational Mathematics and Mathematical Physics 7(4), 1967), a (0, 2)-sequence in base 2:
//! of each aligned block of 2^k samples, every one of the 2^k cells of every grid of 2^a by 2^(k - a) cells has exactly one. Both
//! numbers are scrambled as by A. B. Owen ("Randomly permuted (t,m,s)-nets and (t,s)-sequences", 1995), which keeps that and makes each sample
//! uniform by itself. Every use of numbers (pixel, bounce, branch, purpose) has its own scrambling, and visits the sequence in an order of
//! its own: the index is scrambled, too, so that an aligned block of 2^k samples stays one. This is the padding of B. Burley, "Practical
//! Hash-based Owen Scrambling", Journal of Computer Graphics Techniques 9(4), 2020. There is no last dimension and no largest number of samples
//! but that of the index, 2^32.
//!
//! The order matters beyond that: smallpt's camera gives every fourth sample the same subpixel. Sobol's own order would show each subpixel a
//! quarter of the square, whatever the number of samples, and a scrambled order would show it samples that are hardly better than
//! independent. Here sample k and the pair stand as if k modulo 4 were the first digit of a third dimension of the same sequence, in base 4: of 4^m
//! samples, the 4^(m-1) of each subpixel have exactly one in each of the cells of every grid of 4^a by 4^(m-1-a) cells. Such a third
//! dimension exists because the two binary ones are also those of H. Faure's sequence ("Discrepance de suites associees a un systeme de numeration",
//! 1982) over the field of four elements, which has four.

use super::independent::{mix, unit};
use super::{Address, Sampler};

/// The sampler; it has no state.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sobol;

/// Scrambles binary digits, the first in the lowest bit: each is flipped or not by what the key makes of those before it. Zeros beyond the
/// last digit become random ones.
///
/// The idea is that of S. Laine and T. Karras, "Stratified Sampling for Stochastic Transparency", 2011: sums and products carry upwards only.
/// Their steps flip digits that ought to be independent together, so these are others, keyed throughout.
#[inline(always)]
fn scramble(mut digits: u64, [a, b]: [u64; 2]) -> u64 {
    digits ^= digits.wrapping_mul(b << 1);
    digits = digits.wrapping_add(a);
    digits = digits.wrapping_mul(b.rotate_left(32) | 1);
    digits ^= digits.wrapping_mul(a.rotate_left(32) << 1);
    digits.wrapping_add(b.rotate_left(16))
}

/// The digits of Sobol's second dimension, the first in the lowest bit: the index times Pascal's triangle modulo 2, which is five
/// times the Kronecker product of one of two rows. (The first dimension is the index itself.)
#[inline(always)]
fn pascal(mut index: u32) -> u32 {
    index ^= index >> 1 & 0x5555_5555;
    index ^= index >> 2 & 0x3333_3333;
    index ^= index >> 4 & 0x0F0F_0F0F;
    index ^= index >> 8 & 0x00FF_00FF;
    index ^ index >> 16
}

/// Sixteen elements of the field of four, each times ω. An element is two bits: 1 is the lower, ω the higher, and ω² = ω + 1.
#[inline(always)]
fn times_omega(elements: u32) -> u32 {
    let higher = elements >> 1;
    higher & 0x5555_5555 | ((elements ^ higher) & 0x5555_5555) << 1
}

/// The sum of ω^i times digit i - 1 over the digits of a number in base 4: what the later digits put into the first one of Faure's
/// dimension for ω.
#[inline(always)]
fn later_digits(digits: u32) -> u32 {
    // By halves: ω^8 = ω², ω^4 = ω, ω^2, ω, and once more for the first.
    let sum = digits ^ digits >> 16 ^ times_omega(digits >> 16);
    let sum = sum ^ times_omega(sum >> 8);
    let sum = sum ^ sum >> 4 ^ times_omega(sum >> 4);
    let sum = sum ^ times_omega(sum >> 2);
    times_omega(sum) & 3
}

/// The orders of four, two bits for each.
const ORDERS: [u8; 24] = {
    let mut orders = [0; 24];
    let (mut place, mut code) = (0, 0);
    while place < 24 {
        let (a, b, c) = (code & 3, code >> 2 & 3, code >> 4 & 3);
        if a != b && b != c && a != c {
            orders[place] = code | (6 - a - b - c) << 6;
            place += 1;
        }
        code += 1;
    }
    orders
};

/// The place in the sequence of a sample: aligned blocks of 2^m go to such blocks.
#[inline(always)]
fn place(sample: u32, [a, b]: [u64; 2]) -> u32 {
    // Digits count from the highest here, so that samples that follow each other stay in one block.
    let fours = (scramble(u64::from((sample >> 2).reverse_bits()), [a, b]) as u32).reverse_bits() & (u32::MAX >> 2);
    let order = ORDERS[(((a >> 32) * ORDERS.len() as u64) >> 32) as usize];
    let subpixel = u32::from(order >> (2 * (sample & 3))) & 3;
    fours << 2 | subpixel ^ later_digits(fours)
}

impl Sampler for Sobol {
    #[inline(always)]
    fn pair(&self, at: Address) -> [f64; 2] {
        let dimension = u64::from(at.bounce) << 32 | u64::from(at.branch) << 16 | at.purpose as u64;
        // The same for a whole path, so a compiler takes it out of the loop over bounces.
        let pixel = mix(mix(u64::from(at.key.pixel)) ^ mix(at.key.seed));
        let key = mix(pixel ^ dimension);
        let [order, first, second] = [0, 2, 4].map(|k| [mix(key ^ k), mix(key ^ (k + 1))]);
        let index = place(at.key.sample, order);
        let digits = [scramble(u64::from(index), first), scramble(u64::from(pascal(index)), second)];
        digits.map(|digits| unit(digits.reverse_bits()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sobol's second dimension from his own recurrence: the polynomial x + 1 makes each direction number from the one before it.
    #[test]
    fn the_second_dimension_is_sobols() {
        let mut directions = [1_u32 << 31; 32];
        for k in 1..32 {
            directions[k] = directions[k - 1] ^ directions[k - 1] >> 1;
        }
        for index in (0..1 << 12).chain((0..32).map(|k| 1 << k)).chain([u32::MAX, 0xDEAD_BEEF]) {
            let bits = (0..32).filter(|k| index >> k & 1 == 1);
            let expected = bits.fold(0, |sum, k| sum ^ directions[k]);
            assert_eq!(pascal(index).reverse_bits(), expected, "{index}");
        }
    }

    /// Owen's scrambling flips each digit independently for every way of the digits before it. The 63 flips of six digits, over a million
    /// keys: even, and no two of them go together. (Laine and Karras's own steps fail by a hundred standard deviations.)
    #[test]
    fn scrambling_flips_digits_independently() {
        const LEVELS: u32 = 6;
        const NODES: usize = (1 << LEVELS) - 1;
        const KEYS: u64 = 1 << 20;
        let (mut single, mut double) = ([0_i64; NODES], vec![0_i64; NODES * NODES]);
        for key in 0..KEYS {
            let keys = [mix(2 * key), mix(2 * key + 1)];
            let mut flips = [0_i64; NODES];
            for level in 0..LEVELS {
                for before in 0..1_u64 << level {
                    let flip = scramble(before, keys) >> level & 1;
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
        // Two-sided, 1e-3 for all 2016 sums together.
        let limit = 5.03;
        for (index, sum) in sums.iter().enumerate() {
            let z = *sum as f64 / (KEYS as f64).sqrt();
            assert!(z.abs() < limit, "sum {index} is {z} standard deviations from 0");
        }
    }

    /// The digits before decide, and none after: what makes it a scrambling of nets.
    #[test]
    fn scrambling_keeps_what_leading_digits_share() {
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

    /// Each four samples come in any of their 24 orders.
    #[test]
    fn orders_are_all_different() {
        let mut orders = ORDERS.to_vec();
        orders.sort_unstable();
        orders.dedup();
        assert_eq!(orders.len(), 24);
        for order in orders {
            assert_eq!((0..4).fold(0, |seen, k| seen | 1 << (order >> (2 * k) & 3)), 0b1111);
        }
    }
}
