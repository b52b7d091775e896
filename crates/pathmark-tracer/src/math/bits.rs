//! Words of 64 bits from which random numbers are mixed: `u64`, or SIMD lanes with the same results per lane.

use std::ops::{BitAnd, BitOr, BitXor};

/// 64 bits, or several such words side by side. Registers of 32-bit words are for work that needs only the lower halves
/// of words: they have 32 bits wherever the descriptions below say 64.
pub trait Bits: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + BitXor<Output = Self> {
    /// The same word in every lane.
    fn splat(word: u64) -> Self;
    /// The sum modulo 2^64.
    #[must_use]
    fn plus(self, other: Self) -> Self;
    /// The product modulo 2^64.
    #[must_use]
    fn times(self, other: Self) -> Self;
    /// The full 64-bit product of the lower 32 bits of both; words of 32 bits have its lower half.
    #[must_use]
    fn times_low(self, other: Self) -> Self;
    /// Shifted towards the higher bits by `N` < 64.
    #[must_use]
    fn up<const N: u32>(self) -> Self;
    /// Shifted towards the lower bits by `N` < 64; zeros come in.
    #[must_use]
    fn down<const N: u32>(self) -> Self;
    /// Shifted towards the lower bits, each lane by its own count below 64.
    #[must_use]
    fn down_by(self, count: Self) -> Self;
    /// The bits in reverse order.
    #[must_use]
    fn reversed(self) -> Self;
    /// The lower 32 bits in reverse order, and no others.
    #[must_use]
    #[inline(always)]
    fn mirrored(self) -> Self {
        self.up::<32>().reversed()
    }
}

impl Bits for u64 {
    #[inline(always)]
    fn splat(word: u64) -> Self {
        word
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        self.wrapping_mul(other)
    }
    #[inline(always)]
    fn times_low(self, other: Self) -> Self {
        u64::from(self as u32) * u64::from(other as u32)
    }
    #[inline(always)]
    fn up<const N: u32>(self) -> Self {
        self << N
    }
    #[inline(always)]
    fn down<const N: u32>(self) -> Self {
        self >> N
    }
    #[inline(always)]
    fn down_by(self, count: Self) -> Self {
        self >> count
    }
    #[inline(always)]
    fn reversed(self) -> Self {
        self.reverse_bits()
    }
}

/// The top 53 bits as a multiple of 2^-53 in [0, 1): exact, and never 1.
#[inline(always)]
pub fn unit(bits: u64) -> f64 {
    const STEP: f64 = 1.0 / 9_007_199_254_740_992.0;
    (bits >> 11) as f64 * STEP
}

/// The top 24 bits as a multiple of 2^-24 in [0, 1): exact, and never 1.
#[inline(always)]
pub fn single_unit(bits: u64) -> f32 {
    const STEP: f32 = 1.0 / 16_777_216.0;
    (bits >> 40) as f32 * STEP
}
