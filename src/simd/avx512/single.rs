//! Single precision: sixteen numbers in a register.

use super::{F64x8, Mask16, U64x8};
use crate::math::{Bits, Real};
use crate::simd::two::Two;
use crate::simd::{Float, Table};
use std::arch::x86_64::{
    __m512, __m512i, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm_loadu_ps, _mm256_castps_pd, _mm512_abs_ps, _mm512_add_ps,
    _mm512_castpd_ps, _mm512_castpd256_pd512, _mm512_castps_si512, _mm512_castps128_ps512, _mm512_castsi256_si512,
    _mm512_castsi512_ps, _mm512_cmp_ps_mask, _mm512_cvtepi32_ps, _mm512_cvtepi64_epi32, _mm512_cvtpd_ps,
    _mm512_cvttps_epi32, _mm512_div_ps, _mm512_fmadd_ps, _mm512_insertf32x4, _mm512_insertf64x4, _mm512_inserti64x4,
    _mm512_loadu_ps, _mm512_mask_blend_ps, _mm512_mask_expand_ps, _mm512_mask_mov_ps, _mm512_max_ps, _mm512_min_ps,
    _mm512_mul_ps, _mm512_permutex2var_ps, _mm512_reduce_min_ps, _mm512_set1_ps, _mm512_shuffle_ps, _mm512_sqrt_ps,
    _mm512_storeu_ps, _mm512_storeu_si512, _mm512_sub_ps, _mm512_ternarylogic_epi32, _mm512_unpackhi_ps,
    _mm512_unpacklo_ps, _mm512_xor_ps,
};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Sixteen numbers.
#[derive(Clone, Copy)]
pub(in crate::simd) struct F32x16(__m512);

operator!(F32x16: Add add _mm512_add_ps, Sub sub _mm512_sub_ps, Mul mul _mm512_mul_ps, Div div _mm512_div_ps);

impl Neg for F32x16 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(op!(_mm512_xor_ps(self.0, _mm512_set1_ps(-0.0))))
    }
}

impl Real for F32x16 {
    type Mask = Mask16;
    const SIGNIFICAND: u32 = f32::MANTISSA_DIGITS;
    const SMALLEST: f64 = f32::SMALLEST;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(op!(_mm512_set1_ps(value as f32)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(op!(_mm512_sqrt_ps(self.0)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(op!(_mm512_abs_ps(self.0)))
    }
    #[inline(always)]
    fn times_plus(self, factor: Self, addend: Self) -> Self {
        Self(op!(_mm512_fmadd_ps(self.0, factor.0, addend.0)))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        // Bit by bit: the sign's where the first is set, else the magnitude's.
        let bits = op!(_mm512_ternarylogic_epi32::<0xCA>(
            _mm512_castps_si512(_mm512_set1_ps(-0.0)),
            _mm512_castps_si512(sign.0),
            _mm512_castps_si512(self.0)
        ));
        Self(op!(_mm512_castsi512_ps(bits)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Mask16 {
        Mask16(op!(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Mask16 {
        Mask16(op!(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn select(mask: Mask16, yes: Self, no: Self) -> Self {
        Self(op!(_mm512_mask_blend_ps(mask.0, no.0, yes.0)))
    }
}

impl Float for F32x16 {
    type Bits = Two<U64x8>;
    type One = f32;
    type Single = Self;
    const LANES: usize = 16;

    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        assert!(from.len() >= 16);
        Self(op!(_mm512_loadu_ps(from.as_ptr())))
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        assert!(to.len() >= 16);
        op!(_mm512_storeu_ps(to.as_mut_ptr(), self.0));
    }
    #[inline(always)]
    fn fill(self, mask: Mask16, from: &[f32]) -> Self {
        Self(op!(_mm512_mask_expand_ps(self.0, mask.0, Self::load(from).0)))
    }
    #[inline(always)]
    fn one(value: f64) -> f32 {
        value as f32
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        let mut all = [0.0; 16];
        self.store(&mut all);
        f64::from(all[lane])
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        self.0 = op!(_mm512_mask_mov_ps(self.0, 1 << lane, _mm512_set1_ps(value as f32)));
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Mask16 {
        Mask16(op!(_mm512_cmp_ps_mask::<_CMP_EQ_OQ>(self.0, other.0)))
    }
    // As the processor does it where one is NaN: the second.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self(op!(_mm512_max_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self(op!(_mm512_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn least(self) -> f64 {
        f64::from(op!(_mm512_reduce_min_ps(self.0)))
    }
    #[inline(always)]
    fn number(bits: Two<U64x8>) -> Self {
        op!({
            let lower = _mm256_castps_pd(_mm512_cvtpd_ps(F64x8::number(bits.0).0));
            let upper = _mm256_castps_pd(_mm512_cvtpd_ps(F64x8::number(bits.1).0));
            Self(_mm512_castpd_ps(_mm512_insertf64x4::<1>(_mm512_castpd256_pd512(lower), upper)))
        })
    }
    #[inline(always)]
    fn unit(bits: Two<U64x8>) -> Self {
        let bits = bits.down::<40>();
        let numbers = op!({
            let lower = _mm512_castsi256_si512(_mm512_cvtepi64_epi32(bits.0.0));
            _mm512_cvtepi32_ps(_mm512_inserti64x4::<1>(lower, _mm512_cvtepi64_epi32(bits.1.0)))
        });
        Self(numbers) * Self::splat(1.0 / 16_777_216.0)
    }
    #[inline(always)]
    fn rows(table: &Table, rows: Self) -> [Self; 4] {
        if let Some(columns) = &table.single_columns {
            let index = op!(_mm512_cvttps_epi32(rows.0));
            let [a, b, c, d] = columns;
            return [entries(a, index), entries(b, index), entries(c, index), entries(d, index)];
        }
        let mut n = [0; 16];
        op!(_mm512_storeu_si512(n.as_mut_ptr().cast(), _mm512_cvttps_epi32(rows.0)));
        let a = four(table, [n[0], n[4], n[8], n[12]]);
        let b = four(table, [n[1], n[5], n[9], n[13]]);
        let c = four(table, [n[2], n[6], n[10], n[14]]);
        let d = four(table, [n[3], n[7], n[11], n[15]]);
        // The transpose of four by four, in each quarter of the register.
        op!({
            let (ab0, ab1) = (_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
            let (cd0, cd1) = (_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
            [
                Self(_mm512_shuffle_ps::<0b01_00_01_00>(ab0, cd0)),
                Self(_mm512_shuffle_ps::<0b11_10_11_10>(ab0, cd0)),
                Self(_mm512_shuffle_ps::<0b01_00_01_00>(ab1, cd1)),
                Self(_mm512_shuffle_ps::<0b11_10_11_10>(ab1, cd1)),
            ]
        })
    }
}

/// Entries of a column by their numbers.
#[inline(always)]
fn entries(column: &[f32; 32], index: __m512i) -> F32x16 {
    let (low, high) = (F32x16::load(&column[..16]), F32x16::load(&column[16..]));
    F32x16(op!(_mm512_permutex2var_ps(low.0, index, high.0)))
}

/// Four rows in one register.
#[inline(always)]
fn four(table: &Table, numbers: [i32; 4]) -> __m512 {
    let [a, b, c, d] = [
        table.single_row(numbers[0]),
        table.single_row(numbers[1]),
        table.single_row(numbers[2]),
        table.single_row(numbers[3]),
    ];
    op!({
        let first = _mm512_castps128_ps512(_mm_loadu_ps(a.as_ptr()));
        let second = _mm512_insertf32x4::<1>(first, _mm_loadu_ps(b.as_ptr()));
        let third = _mm512_insertf32x4::<2>(second, _mm_loadu_ps(c.as_ptr()));
        _mm512_insertf32x4::<3>(third, _mm_loadu_ps(d.as_ptr()))
    })
}
