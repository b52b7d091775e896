//! NEON, which every 64-bit ARM processor has: registers of 128 bits; a mask is a register whose lanes are all ones or
//! all zeros.
//!
//! There are twice as many registers as on AVX2, each of half the size, so four work side by side instead of two.

#![expect(unsafe_code, reason = "the compiler offers the instructions of a processor as unsafe functions")]

/// An intrinsic of NEON.
macro_rules! op {
    ($call:expr) => {
        // SAFETY: all processors with this architecture have NEON; loads and stores go to arrays of the register's size.
        unsafe { $call }
    };
}

/// Operators of a register that are one intrinsic each.
macro_rules! operator {
    ($Type:ident: $($Trait:ident $method:ident $intrinsic:ident),*) => {$(
        impl std::ops::$Trait for $Type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(op!(arm::$intrinsic(self.0, other.0)))
            }
        }
    )*};
}

/// A register of numbers by its intrinsics. `own` holds its own implementations of the other methods of
/// [`Float`](super::Float).
macro_rules! register {
    (
        $(#[$about:meta])*
        $Type:ident($Raw:ident) = $lanes:literal $One:ident, $Mask:ident, $Bits:ty, $Single:ty;
        splat $splat:ident, load $load:ident, store $store:ident, fused $fused:ident,
        add $add:ident, sub $sub:ident, mul $mul:ident, div $div:ident, neg $neg:ident, abs $abs:ident,
        sqrt $sqrt:ident, least $least:ident, lt $lt:ident, le $le:ident, equal $equal:ident, select $select:ident;
        sign = $sign:expr;
        own { $(fn $own:ident($($argument:tt)*) $(-> $Result:ty)? $body:block)* }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy)]
        pub(in crate::simd) struct $Type(pub(super) arm::$Raw);

        operator!($Type: Add add $add, Sub sub $sub, Mul mul $mul, Div div $div);

        impl std::ops::Neg for $Type {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(op!(arm::$neg(self.0)))
            }
        }

        impl pathmark_tracer::math::Real for $Type {
            type Mask = $Mask;
            const SIGNIFICAND: u32 = $One::MANTISSA_DIGITS;
            const SMALLEST: f64 = $One::SMALLEST;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                Self(op!(arm::$splat(value as $One)))
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(op!(arm::$sqrt(self.0)))
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self(op!(arm::$abs(self.0)))
            }
            #[inline(always)]
            fn times_plus(self, factor: Self, addend: Self) -> Self {
                if Self::IS_DOUBLE { self * factor + addend } else { self.about_times_plus(factor, addend) }
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                Self(op!(arm::$select($sign, sign.0, self.0)))
            }
            #[inline(always)]
            fn lt(self, other: Self) -> $Mask {
                $Mask(op!(arm::$lt(self.0, other.0)))
            }
            #[inline(always)]
            fn le(self, other: Self) -> $Mask {
                $Mask(op!(arm::$le(self.0, other.0)))
            }
            #[inline(always)]
            fn select(mask: $Mask, yes: Self, no: Self) -> Self {
                Self(op!(arm::$select(mask.0, yes.0, no.0)))
            }
        }

        impl crate::simd::Float for $Type {
            type Bits = $Bits;
            type Digits = $Bits;
            type One = $One;
            type Single = $Single;
            type Register = Self;
            const LANES: usize = $lanes;

            #[inline(always)]
            fn load(from: &[$One]) -> Self {
                assert!(from.len() >= $lanes);
                Self(op!(arm::$load(from.as_ptr())))
            }
            #[inline(always)]
            fn store(self, to: &mut [$One]) {
                assert!(to.len() >= $lanes);
                op!(arm::$store(to.as_mut_ptr(), self.0));
            }
            #[inline(always)]
            fn one(value: f64) -> $One {
                value as $One
            }
            #[inline(always)]
            fn lane(&self, lane: usize) -> f64 {
                let mut all = [0.0; $lanes];
                self.store(&mut all);
                all[lane].into()
            }
            #[inline(always)]
            fn set_lane(&mut self, lane: usize, value: f64) {
                let mut all = [0.0; $lanes];
                self.store(&mut all);
                all[lane] = value as $One;
                *self = Self::load(&all);
            }
            #[inline(always)]
            fn equal(self, other: Self) -> $Mask {
                $Mask(op!(arm::$equal(self.0, other.0)))
            }
            #[inline(always)]
            fn least(self) -> f64 {
                op!(arm::$least(self.0)).into()
            }
            #[inline(always)]
            fn about_times_plus(self, factor: Self, addend: Self) -> Self {
                Self(op!(arm::$fused(addend.0, self.0, factor.0)))
            }
            #[inline(always)]
            fn halves(bits: $Bits) -> [$Bits; 2] {
                [bits, pathmark_tracer::math::Bits::down::<32>(bits)]
            }
            #[inline(always)]
            fn choose_digits(mask: $Mask, yes: $Bits, no: $Bits) -> $Bits {
                <$Bits as crate::simd::Words<$Mask>>::choose(mask, yes, no)
            }
            #[inline(always)]
            fn fraction(digits: $Bits) -> Self {
                Self::unit(pathmark_tracer::math::Bits::reversed(digits))
            }
            #[inline(never)]
            fn apart<W: crate::simd::Apart>(work: W) -> W::Output {
                work.run()
            }
            $(
                #[inline(always)]
                fn $own($($argument)*) $(-> $Result)? $body
            )*
        }
    };
}

mod double;
mod single;

use super::pair::{HalfMask, Pair, PairMask};
use super::{Mask, Precision, Words, Work};
use double::F64x2;
use pathmark_tracer::math::Bits;
use single::F32x4;
use std::arch::aarch64 as arm;
use std::arch::is_aarch64_feature_detected;
use std::ops::Not;

/// Whether this processor has the instructions used here.
pub(super) fn is_available() -> bool {
    is_aarch64_feature_detected!("neon")
}

/// Runs `work` with this instruction set.
pub(super) fn run<W: Work>(precision: Precision, work: W) -> W::Output {
    match precision {
        Precision::F64 => work.run::<Pair<Pair<F64x2>>>(),
        Precision::F32 => work.run::<Pair<Pair<F32x4>>>(),
    }
}

#[derive(Clone, Copy)]
pub(super) struct U64x2(arm::uint64x2_t);

/// All ones or all zeros in each lane.
#[derive(Clone, Copy)]
pub(super) struct Mask2(arm::uint64x2_t);

/// All ones or all zeros in each lane of a register of single precision.
#[derive(Clone, Copy)]
pub(super) struct Mask4(arm::uint32x4_t);

operator!(U64x2: BitAnd bitand vandq_u64, BitOr bitor vorrq_u64, BitXor bitxor veorq_u64);
operator!(Mask2: BitAnd bitand vandq_u64, BitOr bitor vorrq_u64);
operator!(Mask4: BitAnd bitand vandq_u32, BitOr bitor vorrq_u32);

/// Two words as their halves, the lower half of each word first.
#[inline(always)]
fn split(words: arm::uint64x2_t) -> arm::uint32x4_t {
    op!(arm::vreinterpretq_u32_u64(words))
}

#[inline(always)]
fn joined(halves: arm::uint32x4_t) -> arm::uint64x2_t {
    op!(arm::vreinterpretq_u64_u32(halves))
}

impl Bits for U64x2 {
    #[inline(always)]
    fn splat(word: u64) -> Self {
        Self(op!(arm::vdupq_n_u64(word)))
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(op!(arm::vaddq_u64(self.0, other.0)))
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        // Long multiplication by halves; the product of the higher halves is beyond 64 bits.
        op!({
            let crossed = arm::vpaddlq_u32(arm::vmulq_u32(split(self.0), arm::vrev64q_u32(split(other.0))));
            let high = arm::vshlq_n_u64::<32>(crossed);
            Self(arm::vmlal_u32(high, arm::vmovn_u64(self.0), arm::vmovn_u64(other.0)))
        })
    }
    #[inline(always)]
    fn times_low(self, other: Self) -> Self {
        Self(op!(arm::vmull_u32(arm::vmovn_u64(self.0), arm::vmovn_u64(other.0))))
    }
    #[inline(always)]
    fn up<const N: u32>(self) -> Self {
        Self(op!(arm::vshlq_u64(self.0, arm::vdupq_n_s64(i64::from(N)))))
    }
    #[inline(always)]
    fn down<const N: u32>(self) -> Self {
        // A negative count shifts towards the lower bits.
        Self(op!(arm::vshlq_u64(self.0, arm::vdupq_n_s64(-i64::from(N)))))
    }
    #[inline(always)]
    fn down_by(self, count: Self) -> Self {
        Self(op!(arm::vshlq_u64(self.0, arm::vnegq_s64(arm::vreinterpretq_s64_u64(count.0)))))
    }
    #[inline(always)]
    fn reversed(self) -> Self {
        // Reverses the bits of each byte, then the bytes of each word.
        op!({
            let bytes = arm::vrbitq_u8(arm::vreinterpretq_u8_u64(self.0));
            Self(arm::vreinterpretq_u64_u8(arm::vrev64q_u8(bytes)))
        })
    }
}

impl Not for Mask2 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(joined(op!(arm::vmvnq_u32(split(self.0)))))
    }
}

impl Mask for Mask2 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(op!(arm::vtstq_u64(arm::vdupq_n_u64(bits.into()), arm::vld1q_u64([1, 2].as_ptr()))))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        op!(arm::vaddvq_u64(arm::vandq_u64(self.0, arm::vld1q_u64([1, 2].as_ptr())))) as u32
    }
}

impl HalfMask for Mask2 {
    const LANES: u32 = 2;
    #[inline(always)]
    fn bits_of_both(lower: Self, upper: Self) -> u32 {
        Mask4::of_halves(Pair(lower, upper)).bits()
    }
}

impl Not for Mask4 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(op!(arm::vmvnq_u32(self.0)))
    }
}

impl Mask for Mask4 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(op!(arm::vtstq_u32(arm::vdupq_n_u32(bits), arm::vld1q_u32([1, 2, 4, 8].as_ptr()))))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        op!(arm::vaddvq_u32(arm::vandq_u32(self.0, arm::vld1q_u32([1, 2, 4, 8].as_ptr()))))
    }
}

impl HalfMask for Mask4 {
    const LANES: u32 = 4;
    #[inline(always)]
    fn bits_of_both(lower: Self, upper: Self) -> u32 {
        op!({
            // Lanes of 16 bits: the lower half of each lane.
            let [lower, upper] = [arm::vreinterpretq_u16_u32(lower.0), arm::vreinterpretq_u16_u32(upper.0)];
            let each = arm::vld1q_u16([1, 2, 4, 8, 16, 32, 64, 128].as_ptr());
            arm::vaddvq_u16(arm::vandq_u16(arm::vuzp1q_u16(lower, upper), each)).into()
        })
    }
}

impl PairMask for Mask4 {
    type Half = Mask2;
    #[inline(always)]
    fn halves(self) -> Pair<Mask2> {
        let [lower, upper] = op!([arm::vzip1q_u32(self.0, self.0), arm::vzip2q_u32(self.0, self.0)]);
        Pair(Mask2(joined(lower)), Mask2(joined(upper)))
    }
    #[inline(always)]
    fn of_halves(halves: Pair<Mask2>) -> Self {
        Self(op!(arm::vuzp1q_u32(split(halves.0.0), split(halves.1.0))))
    }
}

impl Words<Mask2> for U64x2 {
    #[inline(always)]
    fn load(from: &[u64]) -> Self {
        assert!(from.len() >= 2);
        Self(op!(arm::vld1q_u64(from.as_ptr())))
    }
    #[inline(always)]
    fn store(self, to: &mut [u64]) {
        assert!(to.len() >= 2);
        op!(arm::vst1q_u64(to.as_mut_ptr(), self.0));
    }
    #[inline(always)]
    fn fill(self, mask: Mask2, from: &[u64]) -> Self {
        Self::choose(mask, Self(spread(mask, Self::load(from).0)), self)
    }
    #[inline(always)]
    fn word(&self, lane: usize) -> u64 {
        let mut all = [0; 2];
        self.store(&mut all);
        all[lane]
    }
    #[inline(always)]
    fn set_word(&mut self, lane: usize, word: u64) {
        let mut all = [0; 2];
        self.store(&mut all);
        all[lane] = word;
        *self = Self::load(&all);
    }
    #[inline(always)]
    fn choose(mask: Mask2, yes: Self, no: Self) -> Self {
        Self(op!(arm::vbslq_u64(mask.0, yes.0, no.0)))
    }
    #[inline(always)]
    fn less(self, other: Self) -> Mask2 {
        Mask2(op!(arm::vcltq_u64(self.0, other.0)))
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Mask2 {
        Mask2(op!(arm::vceqq_u64(self.0, other.0)))
    }
}

/// The lowest words, moved to the lanes of a mask in order: the second lane takes the second word only if the first
/// lane takes the first.
#[inline(always)]
fn spread(mask: Mask2, words: arm::uint64x2_t) -> arm::uint64x2_t {
    op!({
        let is_first_taken = arm::vdupq_laneq_u64::<0>(mask.0);
        arm::vbslq_u64(is_first_taken, words, arm::vdupq_laneq_u64::<0>(words))
    })
}
