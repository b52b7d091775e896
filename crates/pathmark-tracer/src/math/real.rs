//! The number trait of the leaf formulas: `f64`, `f32` to measure its cost, and SIMD lanes of the same formulas.
//!
//! A formula over [`Real`] may not branch on a value; it computes both sides and selects. Each operation is one that IEEE 754 rounds
//! exactly (no reciprocal estimate), so every implementation of a precision gives the same bits per lane.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};

/// A real number, or several side by side.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The result of a comparison, one per lane.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask>;

    /// Binary digits of the significand: 53 in double precision, 24 in single.
    const SIGNIFICAND: u32;
    /// Whether single precision has fewer digits.
    const IS_DOUBLE: bool = Self::SIGNIFICAND > f32::MANTISSA_DIGITS;
    /// The smallest positive number with all of these digits.
    const SMALLEST: f64;

    /// The same constant in every lane.
    fn splat(value: f64) -> Self;
    /// The correctly rounded square root; NaN below zero.
    #[must_use]
    fn sqrt(self) -> Self;
    /// The magnitude.
    #[must_use]
    fn abs(self) -> Self;
    /// `self * factor + addend`, rounded after each operation. SIMD lanes of single precision round only once, on every
    /// processor. (Not all processors have an instruction for that, and double precision must have the same bits with
    /// one number as with many.)
    #[must_use]
    fn times_plus(self, factor: Self, addend: Self) -> Self;
    /// The magnitude of `self` with the sign of `sign`, zeros included.
    #[must_use]
    fn copysign(self, sign: Self) -> Self;
    /// `self < other`; false if either is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false if either is NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// `yes` where the mask holds, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
}

macro_rules! float {
    ($Float:ident) => {
        impl Real for $Float {
            type Mask = bool;
            const SIGNIFICAND: u32 = $Float::MANTISSA_DIGITS;
            const SMALLEST: f64 = $Float::MIN_POSITIVE as f64;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                value as $Float
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $Float::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $Float::abs(self)
            }
            #[inline(always)]
            fn times_plus(self, factor: Self, addend: Self) -> Self {
                self * factor + addend
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                $Float::copysign(self, sign)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
        }
    };
}

float!(f64);
float!(f32);

/// The floating-point format of a computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// Double: 53 digits.
    F64,
    /// Single: 24 digits.
    F32,
}

impl Precision {
    /// All formats, the default first.
    pub const ALL: [Self; 2] = [Self::F64, Self::F32];

    /// Its name on the command line, in CSV and TOML.
    pub const fn name(self) -> &'static str {
        match self {
            Self::F64 => "f64",
            Self::F32 => "f32",
        }
    }
}
