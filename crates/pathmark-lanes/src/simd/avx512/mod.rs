//! AVX-512: registers of 512 bits, with masks in separate registers.

#![expect(
    unsafe_code,
    reason = "instructions that not every processor has; `run` alone lets anyone near them, behind `is_available`"
)]

mod double;
mod single;

use super::pair::{HalfMask, Pair, PairMask};
use super::{Apart, Float, Mask, Precision, REVERSED, SWAPPED, SWAPPED_HALVES, SWAPPED_LOWER, Words, Work};
use double::F64x8;
use pathmark_tracer::math::Bits;
use single::F32x16;
use std::arch::x86_64 as x86;
use std::ops::{BitAnd, BitOr, Not};

instruction_set! {
    is_x86_feature_detected["avx512f" "avx512dq" "avx512vl" "avx512bw" "popcnt" "lzcnt" "bmi1" "bmi2"]:
        Pair<F64x8>, Pair<F32x16>;
    ask_for(address) = op!(x86::_mm_prefetch::<{ x86::_MM_HINT_T0 }>(address));
}

#[derive(Clone, Copy)]
pub(super) struct U64x8(x86::__m512i);

/// Sixteen words of 32 bits.
#[derive(Clone, Copy)]
pub(super) struct U32x16(x86::__m512i);

/// One bit per number.
#[derive(Clone, Copy)]
pub(super) struct Mask8(x86::__mmask8);

/// One bit per number of a register of single precision.
#[derive(Clone, Copy)]
pub(super) struct Mask16(x86::__mmask16);

operator!(U64x8(x86): BitAnd bitand _mm512_and_si512, BitOr bitor _mm512_or_si512, BitXor bitxor _mm512_xor_si512);
operator!(U32x16(x86): BitAnd bitand _mm512_and_si512, BitOr bitor _mm512_or_si512, BitXor bitxor _mm512_xor_si512);

/// Sixteen bytes, repeated in every quarter of a register.
#[inline(always)]
fn table(entries: &[i8; 16]) -> x86::__m512i {
    op!(x86::_mm512_broadcast_i32x4(x86::_mm_loadu_si128(entries.as_ptr().cast())))
}

impl Bits for U64x8 {
    #[inline(always)]
    fn splat(word: u64) -> Self {
        Self(op!(x86::_mm512_set1_epi64(word as i64)))
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(op!(x86::_mm512_add_epi64(self.0, other.0)))
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        Self(op!(x86::_mm512_mullo_epi64(self.0, other.0)))
    }
    #[inline(always)]
    fn times_low(self, other: Self) -> Self {
        Self(op!(x86::_mm512_mul_epu32(self.0, other.0)))
    }
    #[inline(always)]
    fn up<const N: u32>(self) -> Self {
        Self(op!(x86::_mm512_slli_epi64::<N>(self.0)))
    }
    #[inline(always)]
    fn down<const N: u32>(self) -> Self {
        Self(op!(x86::_mm512_srli_epi64::<N>(self.0)))
    }
    #[inline(always)]
    fn down_by(self, count: Self) -> Self {
        Self(op!(x86::_mm512_srlv_epi64(self.0, count.0)))
    }
    #[inline(always)]
    fn reversed(self) -> Self {
        Self(op!(x86::_mm512_shuffle_epi8(reversed_bytes(self.0), table(&SWAPPED))))
    }
    #[inline(always)]
    fn mirrored(self) -> Self {
        Self(op!(x86::_mm512_shuffle_epi8(reversed_bytes(self.0), table(&SWAPPED_LOWER))))
    }
}

/// Every byte with its bits in reverse order: half bytes by table.
#[inline(always)]
fn reversed_bytes(bytes: x86::__m512i) -> x86::__m512i {
    op!({
        let (low, high, nibble) = (table(&REVERSED[0]), table(&REVERSED[1]), x86::_mm512_set1_epi8(0x0F));
        let (a, b) =
            (x86::_mm512_and_si512(bytes, nibble), x86::_mm512_and_si512(x86::_mm512_srli_epi64::<4>(bytes), nibble));
        x86::_mm512_or_si512(x86::_mm512_shuffle_epi8(low, a), x86::_mm512_shuffle_epi8(high, b))
    })
}

impl Bits for U32x16 {
    #[inline(always)]
    fn splat(word: u64) -> Self {
        Self(op!(x86::_mm512_set1_epi32(word as i32)))
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(op!(x86::_mm512_add_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        Self(op!(x86::_mm512_mullo_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn times_low(self, other: Self) -> Self {
        self.times(other)
    }
    #[inline(always)]
    fn up<const N: u32>(self) -> Self {
        Self(op!(x86::_mm512_slli_epi32::<N>(self.0)))
    }
    #[inline(always)]
    fn down<const N: u32>(self) -> Self {
        Self(op!(x86::_mm512_srli_epi32::<N>(self.0)))
    }
    #[inline(always)]
    fn down_by(self, count: Self) -> Self {
        Self(op!(x86::_mm512_srlv_epi32(self.0, count.0)))
    }
    #[inline(always)]
    fn reversed(self) -> Self {
        Self(op!(x86::_mm512_shuffle_epi8(reversed_bytes(self.0), table(&SWAPPED_HALVES))))
    }
    #[inline(always)]
    fn mirrored(self) -> Self {
        self.reversed()
    }
}

macro_rules! mask {
    ($Mask:ident, $bits:ident) => {
        impl BitAnd for $Mask {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, other: Self) -> Self {
                Self(self.0 & other.0)
            }
        }

        impl BitOr for $Mask {
            type Output = Self;
            #[inline(always)]
            fn bitor(self, other: Self) -> Self {
                Self(self.0 | other.0)
            }
        }

        impl Not for $Mask {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(!self.0)
            }
        }

        impl Mask for $Mask {
            #[inline(always)]
            fn from_bits(bits: u32) -> Self {
                Self(bits as $bits)
            }
            #[inline(always)]
            fn bits(self) -> u32 {
                u32::from(self.0)
            }
        }

        impl HalfMask for $Mask {
            const LANES: u32 = $bits::BITS;
        }
    };
}

mask!(Mask8, u8);
mask!(Mask16, u16);

impl PairMask for Mask16 {
    type Half = Mask8;
    #[inline(always)]
    fn halves(self) -> Pair<Mask8> {
        Pair(Mask8(self.0 as u8), Mask8((self.0 >> 8) as u8))
    }
    #[inline(always)]
    fn of_halves(halves: Pair<Mask8>) -> Self {
        Self(u16::from(halves.0.0) | u16::from(halves.1.0) << 8)
    }
}

impl Words<Mask8> for U64x8 {
    #[inline(always)]
    fn load(from: &[u64]) -> Self {
        assert!(from.len() >= 8);
        Self(op!(x86::_mm512_loadu_si512(from.as_ptr().cast())))
    }
    #[inline(always)]
    fn store(self, to: &mut [u64]) {
        assert!(to.len() >= 8);
        op!(x86::_mm512_storeu_si512(to.as_mut_ptr().cast(), self.0));
    }
    #[inline(always)]
    fn fill(self, mask: Mask8, from: &[u64]) -> Self {
        Self(op!(x86::_mm512_mask_expand_epi64(self.0, mask.0, Self::load(from).0)))
    }
    #[inline(always)]
    fn word(&self, lane: usize) -> u64 {
        let mut all = [0; 8];
        self.store(&mut all);
        all[lane]
    }
    #[inline(always)]
    fn set_word(&mut self, lane: usize, word: u64) {
        self.0 = op!(x86::_mm512_mask_mov_epi64(self.0, 1 << lane, x86::_mm512_set1_epi64(word as i64)));
    }
    #[inline(always)]
    fn choose(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(op!(x86::_mm512_mask_blend_epi64(mask.0, no.0, yes.0)))
    }
    #[inline(always)]
    fn less(self, other: Self) -> Mask8 {
        Mask8(op!(x86::_mm512_cmplt_epu64_mask(self.0, other.0)))
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Mask8 {
        Mask8(op!(x86::_mm512_cmpeq_epu64_mask(self.0, other.0)))
    }
}
