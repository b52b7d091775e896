//! AVX-512: eight numbers in a register, masks in registers of their own.

#![expect(
    unsafe_code,
    reason = "instructions that not every processor has; `run` alone lets anyone near them, behind `is_available`"
)]

use super::two::{HalfMask, Two};
use super::{Float, Mask, Table, Work};
use crate::math::{Bits, Real};
use std::arch::x86_64::{
    __m512d, __m512i, __mmask8, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm_loadu_si128, _mm512_abs_pd, _mm512_add_epi64,
    _mm512_add_pd, _mm512_and_si512, _mm512_broadcast_i32x4, _mm512_castpd_si512, _mm512_castsi512_pd,
    _mm512_cmp_pd_mask, _mm512_cmpeq_epu64_mask, _mm512_cmplt_epu64_mask, _mm512_cvtepu64_pd, _mm512_cvttpd_epi64,
    _mm512_div_pd, _mm512_loadu_pd, _mm512_loadu_si512, _mm512_mask_blend_epi64, _mm512_mask_blend_pd,
    _mm512_mask_expand_epi64, _mm512_mask_expand_pd, _mm512_mask_mov_epi64, _mm512_mask_mov_pd, _mm512_mul_pd,
    _mm512_mullo_epi64, _mm512_or_si512, _mm512_permutex2var_pd, _mm512_set1_epi64, _mm512_set1_pd,
    _mm512_shuffle_epi8, _mm512_slli_epi64, _mm512_sqrt_pd, _mm512_srli_epi64, _mm512_srlv_epi64, _mm512_storeu_pd,
    _mm512_storeu_si512, _mm512_sub_pd, _mm512_ternarylogic_epi64, _mm512_xor_pd, _mm512_xor_si512,
};
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

/// Whether this processor has what is used here.
pub(super) fn is_available() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512bw")
}

/// Does the work; `None` if this processor cannot.
pub(super) fn run<W: Work>(work: W) -> Option<W::Output> {
    // SAFETY: the features have been found a line above.
    is_available().then(|| unsafe { enter(work) })
}

#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw")]
fn enter<W: Work>(work: W) -> W::Output {
    work.run::<Two<F64x8>>()
}

#[derive(Clone, Copy)]
pub(super) struct F64x8(__m512d);

#[derive(Clone, Copy)]
pub(super) struct U64x8(__m512i);

#[derive(Clone, Copy)]
pub(super) struct Mask8(__mmask8);

operator!(F64x8: Add add _mm512_add_pd, Sub sub _mm512_sub_pd, Mul mul _mm512_mul_pd, Div div _mm512_div_pd);
operator!(U64x8: BitAnd bitand _mm512_and_si512, BitOr bitor _mm512_or_si512, BitXor bitxor _mm512_xor_si512);

impl Neg for F64x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(op!(_mm512_xor_pd(self.0, _mm512_set1_pd(-0.0))))
    }
}

impl Real for F64x8 {
    type Mask = Mask8;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(op!(_mm512_set1_pd(value)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(op!(_mm512_sqrt_pd(self.0)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(op!(_mm512_abs_pd(self.0)))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        // Bit by bit: the sign's where the first is set, else the magnitude's.
        let bits = op!(_mm512_ternarylogic_epi64::<0xCA>(
            _mm512_castpd_si512(_mm512_set1_pd(-0.0)),
            _mm512_castpd_si512(sign.0),
            _mm512_castpd_si512(self.0)
        ));
        Self(op!(_mm512_castsi512_pd(bits)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        Mask8(op!(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        Mask8(op!(_mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(op!(_mm512_mask_blend_pd(mask.0, no.0, yes.0)))
    }
}

/// Sixteen bytes, in every quarter of a register.
#[inline(always)]
fn table(entries: &[i8; 16]) -> __m512i {
    op!(_mm512_broadcast_i32x4(_mm_loadu_si128(entries.as_ptr().cast())))
}

impl Bits for U64x8 {
    #[inline(always)]
    fn splat(word: u64) -> Self {
        Self(op!(_mm512_set1_epi64(word as i64)))
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(op!(_mm512_add_epi64(self.0, other.0)))
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        Self(op!(_mm512_mullo_epi64(self.0, other.0)))
    }
    #[inline(always)]
    fn up<const N: u32>(self) -> Self {
        Self(op!(_mm512_slli_epi64::<N>(self.0)))
    }
    #[inline(always)]
    fn down<const N: u32>(self) -> Self {
        Self(op!(_mm512_srli_epi64::<N>(self.0)))
    }
    #[inline(always)]
    fn down_by(self, count: Self) -> Self {
        Self(op!(_mm512_srlv_epi64(self.0, count.0)))
    }
    #[inline(always)]
    fn reversed(self) -> Self {
        // Half bytes by table, then bytes by shuffle.
        let low = table(&[0, -128, 64, -64, 32, -96, 96, -32, 16, -112, 80, -48, 48, -80, 112, -16]);
        let high = table(&[0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15]);
        let swap = table(&[7, 6, 5, 4, 3, 2, 1, 0, 15, 14, 13, 12, 11, 10, 9, 8]);
        let nibble = Self::splat(0x0F0F_0F0F_0F0F_0F0F);
        let (a, b) = ((self & nibble).0, (self.down::<4>() & nibble).0);
        let bytes = op!(_mm512_or_si512(_mm512_shuffle_epi8(low, a), _mm512_shuffle_epi8(high, b)));
        Self(op!(_mm512_shuffle_epi8(bytes, swap)))
    }
}

macro_rules! mask_operator {
    ($($Trait:ident $method:ident $operator:tt),*) => {$(
        impl $Trait for Mask8 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $operator other.0)
            }
        }
    )*};
}

mask_operator!(BitAnd bitand &, BitOr bitor |);

impl Not for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(bits as u8)
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self.0)
    }
}

impl HalfMask for Mask8 {
    const LANES: u32 = 8;
}

impl Float for F64x8 {
    type Bits = U64x8;
    const LANES: usize = 8;

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        assert!(from.len() >= 8);
        Self(op!(_mm512_loadu_pd(from.as_ptr())))
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        assert!(to.len() >= 8);
        op!(_mm512_storeu_pd(to.as_mut_ptr(), self.0));
    }
    #[inline(always)]
    fn fill(self, mask: Mask8, from: &[f64]) -> Self {
        Self(op!(_mm512_mask_expand_pd(self.0, mask.0, Self::load(from).0)))
    }
    #[inline(always)]
    fn fill_words(bits: U64x8, mask: Mask8, from: &[u64]) -> U64x8 {
        U64x8(op!(_mm512_mask_expand_epi64(bits.0, mask.0, Self::load_words(from).0)))
    }
    #[inline(always)]
    fn store_words(bits: U64x8, to: &mut [u64]) {
        assert!(to.len() >= 8);
        op!(_mm512_storeu_si512(to.as_mut_ptr().cast(), bits.0));
    }
    #[inline(always)]
    fn load_words(from: &[u64]) -> U64x8 {
        assert!(from.len() >= 8);
        U64x8(op!(_mm512_loadu_si512(from.as_ptr().cast())))
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        let mut all = [0.0; 8];
        op!(_mm512_storeu_pd(all.as_mut_ptr(), self.0));
        all[lane]
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        self.0 = op!(_mm512_mask_mov_pd(self.0, 1 << lane, _mm512_set1_pd(value)));
    }
    #[inline(always)]
    fn word(bits: &U64x8, lane: usize) -> u64 {
        let mut all = [0_u64; 8];
        op!(_mm512_storeu_si512(all.as_mut_ptr().cast(), bits.0));
        all[lane]
    }
    #[inline(always)]
    fn set_word(bits: &mut U64x8, lane: usize, word: u64) {
        bits.0 = op!(_mm512_mask_mov_epi64(bits.0, 1 << lane, _mm512_set1_epi64(word as i64)));
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Mask8 {
        Mask8(op!(_mm512_cmp_pd_mask::<_CMP_EQ_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn number(bits: U64x8) -> Self {
        Self(op!(_mm512_cvtepu64_pd(bits.0)))
    }
    #[inline(always)]
    fn unit(bits: U64x8) -> Self {
        Self::number(bits.down::<11>()) * Self::splat(1.0 / 9_007_199_254_740_992.0)
    }
    #[inline(always)]
    fn choose(mask: Mask8, yes: U64x8, no: U64x8) -> U64x8 {
        U64x8(op!(_mm512_mask_blend_epi64(mask.0, no.0, yes.0)))
    }
    #[inline(always)]
    fn less(a: U64x8, b: U64x8) -> Mask8 {
        Mask8(op!(_mm512_cmplt_epu64_mask(a.0, b.0)))
    }
    #[inline(always)]
    fn same(a: U64x8, b: U64x8) -> Mask8 {
        Mask8(op!(_mm512_cmpeq_epu64_mask(a.0, b.0)))
    }
    #[inline(always)]
    fn rows(table: &Table, rows: Self) -> [Self; 4] {
        if let Some(columns) = &table.columns {
            let index = op!(_mm512_cvttpd_epi64(rows.0));
            let mut result = [rows; 4];
            let mut j = 0;
            while j < 4 {
                let column = &columns[j];
                result[j] = Self(op!({
                    let low = _mm512_loadu_pd(column.as_ptr());
                    let high = _mm512_loadu_pd(column.as_ptr().add(8));
                    _mm512_permutex2var_pd(low, index, high)
                }));
                j += 1;
            }
            return result;
        }
        let mut numbers = [0.0; 8];
        op!(_mm512_storeu_pd(numbers.as_mut_ptr(), rows.0));
        let mut columns = [[0.0; 8]; 4];
        let mut lane = 0;
        while lane < 8 {
            let row = table.row(numbers[lane]);
            let mut j = 0;
            while j < 4 {
                columns[j][lane] = row[j];
                j += 1;
            }
            lane += 1;
        }
        [
            Self(op!(_mm512_loadu_pd(columns[0].as_ptr()))),
            Self(op!(_mm512_loadu_pd(columns[1].as_ptr()))),
            Self(op!(_mm512_loadu_pd(columns[2].as_ptr()))),
            Self(op!(_mm512_loadu_pd(columns[3].as_ptr()))),
        ]
    }
}
