//! Owen-scrambled Sobol pairs: `--sampler sobol`.
//!
//! A pair of numbers belongs to the first two dimensions of Sobol's sequence (I. M. Sobol', "On the distribution of
//! points in a cube and the approximate evaluation of integrals", USSR Computational Mathematics and Mathematical
//! Physics 7(4), 1967), a (0, 2)-sequence in base 2: of each aligned block of 2^k samples, each of the 2^k cells of
//! every grid of 2^a by 2^(k - a) cells has exactly one. Owen's scrambling keeps that property and makes each sample
//! uniform by itself. Every use of random numbers (pixel, bounce, branch, purpose) has its own scrambling and its own
//! order of the sequence: the index is scrambled, too. This is the padding of B. Burley, "Practical Hash-based Owen
//! Scrambling", Journal of Computer Graphics Techniques 9(4), 2020. The number of dimensions is unlimited, and only the
//! index's type limits the number of samples.
//!
//! Different uses are then independent of each other. The position in the pixel and the first direction are an
//! exception, because most of a pixel's light depends on them. Their four numbers belong to one (0, 4)-sequence in base
//! 4: the sequence of H. Faure ("Discrépance de suites associées à un système de numération", Acta Arithmetica 41,
//! 1982), taken over the field of four elements, as by H. Niederreiter ("Low-discrepancy and low-dispersion sequences",
//! Journal of Number Theory 30, 1988). The generating matrix for the element a is Pascal's triangle to the power a.
//! Powers add up: the matrices for 0 and 1 are Sobol's two dimensions. The same two, visited in the order that the
//! matrix for ω gives, are the dimensions for ω and ω + 1. So each pair is a (0, 2)-sequence in base 2, and both pairs
//! together are one in base 4. (A. Ahmed and others call such pairs SZ sequences.)
//!
//! smallpt's camera assigns the subpixel k modulo 4 to sample k. In Sobol's own order each subpixel would always get
//! the same quarter of the square. So k modulo 4 becomes the first digit of a fifth dimension, made from a quadratic
//! polynomial in Niederreiter's construction. Of 4^m samples, those of a subpixel are then a (1, m-1, 4)-net in base 4,
//! in the four numbers together.

use super::burley;
pub use super::burley::digits;
use super::independent::mix;
use super::owen::shuffle;
use super::{Address, Purpose, Sampler};
use crate::math::{Bits, unit};

/// The sampler; it has no state.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sobol;

/// Multiplies sixteen elements of the field of four by ω. An element is two bits: the lower is 1, the higher ω. In this
/// field, ω² = ω + 1.
#[inline(always)]
const fn times_omega(elements: u32) -> u32 {
    let higher = elements >> 1;
    higher & LOWER | ((elements ^ higher) & LOWER) << 1
}

/// The lower bit of each element.
const LOWER: u32 = 0x5555_5555;

/// Both bits of the elements `place`, `place + 3`, ...
pub const fn each_third(place: u32) -> u32 {
    let (mut mask, mut bit) = (0, 2 * place);
    while bit < u32::BITS {
        mask |= 3 << bit;
        bit += 6;
    }
    mask
}

/// Element j times ω^j.
#[inline(always)]
fn times_powers(elements: u32) -> u32 {
    let once = times_omega(elements);
    elements & each_third(0) | once & each_third(1) | (elements ^ once) & each_third(2)
}

/// Element j divided by ω^j.
#[inline(always)]
fn over_powers(elements: u32) -> u32 {
    let once = times_omega(elements);
    elements & each_third(0) | (elements ^ once) & each_third(1) | once & each_third(2)
}

/// Pascal's triangle modulo 2 applied to sixteen elements: the Kronecker product of four matrices (1 1; 0 1).
#[inline(always)]
fn pascal_of_elements<B: Bits>(elements: B) -> B {
    let elements = elements ^ elements.down::<2>() & B::splat(0x3333_3333);
    let elements = elements ^ elements.down::<4>() & B::splat(0x0F0F_0F0F);
    let elements = elements ^ elements.down::<8>() & B::splat(0x00FF_00FF);
    elements ^ elements.down::<16>()
}

/// The digits of Sobol's second dimension, the first in the lowest bit: the index times Pascal's triangle of bits. (The first dimension
/// is the index itself.)
#[inline(always)]
fn pascal<B: Bits>(index: B) -> B {
    pascal_of_elements(index ^ index.down::<1>() & B::splat(u64::from(LOWER)))
}

/// The index times Pascal's triangle to the power ω. Its entries are those of the triangle times ω^(column - row).
#[inline(always)]
fn pascal_to_omega(index: u32) -> u32 {
    over_powers(pascal_of_elements(u64::from(times_powers(index))) as u32)
}

/// The coefficients of the fifth dimension's first digit, as one mask for each bit of the products. They follow the
/// recurrence of x² + ω²x + 1, a polynomial without roots in the field, and have period five.
pub const SUBPIXEL: [u32; 2] = {
    let coefficients = [1, 2, 0, 2, 1];
    let (mut masks, mut place) = ([0; 2], 0);
    while place < 16 {
        let one = coefficients[place % 5];
        // The images of an element's two bits: one times 1 and one times ω.
        let (lower, higher) = (one, times_omega(one) & 3);
        let mut bit = 0;
        while bit < 2 {
            masks[bit] |= (lower >> bit & 1 | (higher >> bit & 1) << 1) << (2 * place);
            bit += 1;
        }
        place += 1;
    }
    masks
};

/// The 24 orders of four samples, two bits for each sample.
pub const ORDERS: [u8; 24] = {
    let mut orders = [0; 24];
    let (mut place, mut code) = (0, 0);
    while place < orders.len() {
        let (a, b, c) = (code & 3, code >> 2 & 3, code >> 4 & 3);
        if a != b && b != c && a != c {
            orders[place] = code | (6 - a - b - c) << 6;
            place += 1;
        }
        code += 1;
    }
    orders
};

/// A sample's position in the order that the leading uses share. Groups of four are shuffled. In its group the sample
/// gets the member whose fifth dimension starts with the sample's subpixel.
#[inline(always)]
fn leading(sample: u32, [a, b]: [u64; 2]) -> u32 {
    let fours = (shuffle(u64::from(sample >> 2), [a, b]) as u32) << 2;
    let order = ORDERS[(((a >> 32) * ORDERS.len() as u64) >> 32) as usize];
    let subpixel = u32::from(order >> (2 * (sample & 3))) & 3;
    let [lower, higher] = SUBPIXEL.map(|mask| (fours & mask).count_ones() & 1);
    fours | subpixel ^ lower ^ higher << 1
}

/// The hash of seed and pixel that all random numbers of a pixel share.
#[inline(always)]
pub fn pixel<B: Bits>(seed: u64, pixel: B) -> B {
    mix(mix(pixel) ^ B::splat(mix(seed)))
}

/// A sample's positions in the order that the leading uses share: for the film, and for the direction or light at the
/// first vertex.
#[inline(always)]
pub fn joined(pixel: u64, sample: u32) -> [u32; 2] {
    // No dimension is this large, so no other key is made from these values.
    let place = leading(sample, [mix(pixel ^ u64::MAX), mix(pixel ^ (u64::MAX - 1))]);
    [place, pascal_to_omega(place)]
}

/// The position in the use's own order of a sample with these digits ([`digits`]).
#[inline(always)]
pub fn own_place<B: Bits>(key: B, digits: B) -> B {
    burley::shuffle(digits, mix(key ^ B::splat(1)))
}

/// The two numbers at a position of the sequence, scrambled for a use, as 64-bit fractions.
#[inline(always)]
pub fn fractions<B: Bits>(key: B, place: B) -> [B; 2] {
    [burley::scramble(place, key).reversed(), burley::scramble(pascal(place), key.down::<32>()).reversed()]
}

impl Sampler for Sobol {
    #[inline(always)]
    fn pair(&self, at: Address) -> [f64; 2] {
        let dimension = u64::from(at.bounce) << 32 | u64::from(at.branch) << 16 | at.purpose as u64;
        // Constant along a path, so the compiler moves it out of the loop over bounces.
        let pixel = pixel(at.key.seed, u64::from(at.key.pixel));
        let key = mix(pixel ^ dimension);
        let place = match (at.bounce, at.branch, at.purpose) {
            (0, _, Purpose::Film) => u64::from(joined(pixel, at.key.sample)[0]),
            (1, 0, Purpose::Bsdf | Purpose::Light) => u64::from(joined(pixel, at.key.sample)[1]),
            _ => own_place(key, digits(u64::from(at.key.sample))),
        };
        fractions(key, place).map(unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks Sobol's second dimension against his own recurrence: the polynomial x + 1 makes each direction number
    /// from the previous one.
    #[test]
    fn the_second_dimension_is_sobols() {
        let mut directions = [1_u32 << 31; 32];
        for k in 1..32 {
            directions[k] = directions[k - 1] ^ directions[k - 1] >> 1;
        }
        for index in (0..1 << 12).chain((0..32).map(|k| 1 << k)).chain([u32::MAX, 0xDEAD_BEEF]) {
            let bits = (0..32).filter(|k| index >> k & 1 == 1);
            let expected = bits.fold(0, |sum, k| sum ^ directions[k]);
            assert_eq!((pascal(u64::from(index)) as u32).reverse_bits(), expected, "{index}");
        }
    }

    /// Powers add up, and the field's characteristic is 2.
    #[test]
    fn powers_of_pascals_triangle_add_up() {
        for index in (0..1000).chain((0..32).map(|k| 1 << k)).chain([u32::MAX, 0xDEAD_BEEF]) {
            let twice = pascal_to_omega(pascal_to_omega(index));
            assert_eq!(twice, index, "ω + ω = 0");
            let once = |index: u32| pascal_of_elements(u64::from(index)) as u32;
            assert_eq!(once(pascal_to_omega(index)), pascal_to_omega(once(index)));
        }
        assert_eq!(pascal_to_omega(0b01_00), 0b01_10, "its first row is 1, ω, ω², ...");
        assert_eq!(pascal_to_omega(0b01_00_00), 0b01_00_11);
    }

    /// The table has all 24 orders of four samples.
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
