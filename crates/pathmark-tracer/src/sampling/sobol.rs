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

pub use super::burley::digits;
use super::burley::{self, Seed};
use super::independent::mix;
use super::owen::shuffle;
use super::{Address, Purpose, Sampler};
use crate::math::{Bits, unit};

/// The sampler; it has no state.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sobol;

/// The elements of the field of four times ω. An element is two bits: the lower is 1, the higher ω. In this field,
/// ω² = ω + 1.
const TIMES_OMEGA: [u32; 4] = [0, 2, 3, 1];

/// Multiplies sixteen elements by ω.
#[inline(always)]
fn times_omega<B: Bits>(elements: B) -> B {
    let higher = elements.down::<1>();
    higher & B::splat(LOWER) | ((elements ^ higher) & B::splat(LOWER)).up::<1>()
}

/// The lower bit of each element.
const LOWER: u64 = 0x5555_5555;

/// Both bits of the elements `place`, `place + 3`, ...
pub const fn each_third(place: u32) -> u32 {
    let (mut mask, mut bit) = (0, 2 * place);
    while bit < u32::BITS {
        mask |= 3 << bit;
        bit += 6;
    }
    mask
}

/// The results of [`each_third`].
const THIRDS: [u64; 3] = [each_third(0) as u64, each_third(1) as u64, each_third(2) as u64];

#[inline(always)]
fn third<B: Bits>(elements: B, place: usize) -> B {
    elements & B::splat(THIRDS[place])
}

/// Element j times ω^j.
#[inline(always)]
fn times_powers<B: Bits>(elements: B) -> B {
    let once = times_omega(elements);
    third(elements, 0) | third(once, 1) | third(elements ^ once, 2)
}

/// Element j divided by ω^j.
#[inline(always)]
fn over_powers<B: Bits>(elements: B) -> B {
    let once = times_omega(elements);
    third(elements, 0) | third(elements ^ once, 1) | third(once, 2)
}

/// Pascal's triangle modulo 2 applied to sixteen elements: the Kronecker product of four matrices (1 1; 0 1).
#[inline(always)]
fn pascal_of_elements<B: Bits>(elements: B) -> B {
    let elements = elements ^ elements.down::<2>() & B::splat(0x3333_3333);
    let elements = elements ^ elements.down::<4>() & B::splat(0x0F0F_0F0F);
    let elements = elements ^ elements.down::<8>() & B::splat(0x00FF_00FF);
    elements ^ elements.down::<16>()
}

/// The digits of Sobol's second dimension, the first in the lowest bit: the index times Pascal's triangle of bits. (The
/// first dimension is the index itself.)
#[inline(always)]
fn pascal<B: Bits>(index: B) -> B {
    pascal_of_elements(index ^ index.down::<1>() & B::splat(LOWER))
}

/// The index times Pascal's triangle to the power ω. Its entries are those of the triangle times ω^(column - row).
#[inline(always)]
fn pascal_to_omega<B: Bits>(index: B) -> B {
    over_powers(pascal_of_elements(times_powers(index)))
}

/// The coefficients of the fifth dimension's first digit, as one mask for each bit of the products. They follow the
/// recurrence of x² + ω²x + 1, a polynomial without roots in the field, and have period five.
pub const SUBPIXEL: [u32; 2] = {
    let coefficients = [1, 2, 0, 2, 1];
    let (mut masks, mut place) = ([0; 2], 0);
    while place < 16 {
        let one: u32 = coefficients[place % 5];
        // The images of an element's two bits: one times 1 and one times ω.
        let (lower, higher) = (one, TIMES_OMEGA[one as usize]);
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

/// [`ORDERS`] in words, so that lanes need no table.
const ORDER_WORDS: [u64; 3] = {
    let (mut words, mut place) = ([0; 3], 0);
    while place < ORDERS.len() {
        words[place / 8] |= (ORDERS[place] as u64) << (8 * (place % 8));
        place += 1;
    }
    words
};

/// The subpixel of a sample in the order with that number.
#[inline(always)]
fn subpixel<B: Bits>(order: B, sample: B) -> B {
    let place = (order & B::splat(7)).up::<3>() | (sample & B::splat(3)).up::<1>();
    let [first, second, third] = ORDER_WORDS;
    let word = order.down::<3>();
    let is_second = (word & B::splat(1)).times_low(B::splat(3));
    let is_third = word.down::<1>().times_low(B::splat(3));
    let found = B::splat(first).down_by(place)
        ^ B::splat(first ^ second).down_by(place) & is_second
        ^ B::splat(first ^ third).down_by(place) & is_third;
    found & B::splat(3)
}

/// The first digit of the fifth dimension: the sums of the bits in each mask of [`SUBPIXEL`], modulo 2.
#[inline(always)]
fn fifth<B: Bits>(place: B) -> B {
    let [lower, higher] = SUBPIXEL;
    // The sums of both halves; a half's bits do not reach the lowest bit of the other.
    let sums = place & B::splat(u64::from(lower)) | (place & B::splat(u64::from(higher))).up::<32>();
    let sums = sums ^ sums.down::<16>();
    let sums = sums ^ sums.down::<8>();
    let sums = sums ^ sums.down::<4>();
    let sums = sums ^ sums.down::<2>();
    let sums = sums ^ sums.down::<1>();
    sums & B::splat(1) | sums.down::<31>() & B::splat(2)
}

/// A sample's position in the order that the leading uses share. Groups of four are shuffled. In its group the sample
/// gets the member whose fifth dimension starts with the sample's subpixel.
#[inline(always)]
fn leading<B: Bits>(sample: B, [a, b]: [B; 2]) -> B {
    let fours = shuffle(sample.down::<2>(), [a, b]).up::<2>() & B::splat(u64::from(u32::MAX));
    let order = a.down::<32>().times_low(B::splat(ORDERS.len() as u64)).down::<32>();
    fours | subpixel(order, sample) ^ fifth(fours)
}

/// The hash of seed and pixel that all random numbers of a pixel share.
#[inline(always)]
pub fn pixel<B: Bits>(seed: u64, pixel: B) -> B {
    mix(mix(pixel) ^ B::splat(mix(seed)))
}

/// A sample's positions in the order that the leading uses share: for the film, and for the direction or light at the
/// first vertex.
#[inline(always)]
pub fn joined<B: Bits>(pixel: B, sample: B) -> [B; 2] {
    // No dimension is this large, so no other key is made from these values.
    let place = leading(sample, [mix(pixel ^ B::splat(u64::MAX)), mix(pixel ^ B::splat(u64::MAX - 1))]);
    [place, pascal_to_omega(place)]
}

/// The seed of a use's own order.
#[inline(always)]
pub fn order<B: Bits>(key: B) -> B {
    mix(key ^ B::splat(1))
}

/// The position in the order with that seed of a sample with these digits ([`digits`]).
#[inline(always)]
pub fn own_place<B: Bits>(order: Seed<B>, digits: B) -> B {
    burley::shuffle(digits, order)
}

/// The scrambled digits of the first number at a position of the sequence, the first digit in the lowest bit. The seed
/// is the use's key.
#[inline(always)]
pub fn first<B: Bits>(place: B, seed: Seed<B>) -> B {
    burley::scramble(place, seed)
}

/// The digits of the second number. The seed is the upper half of the use's key.
#[inline(always)]
pub fn second<B: Bits>(place: B, seed: Seed<B>) -> B {
    burley::scramble(pascal(place), seed)
}

impl Sampler for Sobol {
    #[inline(always)]
    fn pair(&self, at: Address) -> [f64; 2] {
        let dimension = u64::from(at.bounce) << 32 | u64::from(at.branch) << 16 | at.purpose as u64;
        // Constant along a path, so the compiler moves it out of the loop over bounces.
        let pixel = pixel(at.key.seed, u64::from(at.key.pixel));
        let key = mix(pixel ^ dimension);
        let sample = u64::from(at.key.sample);
        let place = match (at.bounce, at.branch, at.purpose) {
            (0, _, Purpose::Film) => joined(pixel, sample)[0],
            (1, 0, Purpose::Bsdf | Purpose::Light) => joined(pixel, sample)[1],
            _ => own_place([order(key), order(key) >> 16], digits(sample)),
        };
        [first(place, [key, key >> 16]), second(place, [key >> 32, key >> 48])].map(|digits| unit(digits.reversed()))
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
        for index in (0..1000_u64).chain((0..32).map(|k| 1 << k)).chain([u32::MAX.into(), 0xDEAD_BEEF]) {
            let twice = pascal_to_omega(pascal_to_omega(index));
            assert_eq!(twice, index, "ω + ω = 0");
            assert_eq!(pascal_of_elements(pascal_to_omega(index)), pascal_to_omega(pascal_of_elements(index)));
        }
        assert_eq!(pascal_to_omega(0b01_00_u64), 0b01_10, "its first row is 1, ω, ω², ...");
        assert_eq!(pascal_to_omega(0b01_00_00_u64), 0b01_00_11);
    }

    /// Both multiplications by ω agree, and so do the orders in the table and in words.
    #[test]
    fn words_agree_with_tables() {
        for element in 0..4_u64 {
            assert_eq!(times_omega(element), u64::from(TIMES_OMEGA[element as usize]));
        }
        for (number, order) in (0_u64..).zip(ORDERS) {
            for sample in 0..8_u64 {
                assert_eq!(subpixel(number, sample), u64::from(order >> (2 * (sample & 3)) & 3));
            }
        }
        for place in (0..32).map(|k| 1_u64 << k).chain((0..1000_u64).map(|k| mix(k) >> 32)) {
            let [lower, higher] = SUBPIXEL.map(|mask| u64::from((place as u32 & mask).count_ones() % 2));
            assert_eq!(fifth(place), lower | higher << 1);
        }
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
