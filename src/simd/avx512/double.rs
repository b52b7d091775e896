//! Double precision: eight numbers in a register.

use super::single::F32x16;
use super::{Mask8, U64x8};
use crate::math::{Bits, Real};
use crate::simd::{Float, Table};
use std::arch::x86_64::{
    __m512d, __m512i, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm256_loadu_pd, _mm256_storeu_si256, _mm512_abs_pd,
    _mm512_add_pd, _mm512_castpd_si512, _mm512_castpd256_pd512, _mm512_castsi512_pd, _mm512_cmp_pd_mask,
    _mm512_cmplt_epu64_mask, _mm512_cvtepu64_pd, _mm512_cvttpd_epi32, _mm512_cvttpd_epi64, _mm512_div_pd,
    _mm512_fmadd_pd, _mm512_insertf64x4, _mm512_loadu_pd, _mm512_mask_blend_pd, _mm512_mask_expand_pd,
    _mm512_mask_mov_pd, _mm512_max_epu64, _mm512_max_pd, _mm512_min_epu64, _mm512_min_pd, _mm512_mul_pd,
    _mm512_permutex2var_pd, _mm512_reduce_min_pd, _mm512_set1_pd, _mm512_setr_epi64, _mm512_sqrt_pd, _mm512_storeu_pd,
    _mm512_sub_pd, _mm512_ternarylogic_epi64, _mm512_unpackhi_pd, _mm512_unpacklo_pd, _mm512_xor_pd,
};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Eight numbers.
#[derive(Clone, Copy)]
pub(in crate::simd) struct F64x8(pub(super) __m512d);

operator!(F64x8: Add add _mm512_add_pd, Sub sub _mm512_sub_pd, Mul mul _mm512_mul_pd, Div div _mm512_div_pd);
impl Neg for F64x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(op!(_mm512_xor_pd(self.0, _mm512_set1_pd(-0.0))))
    }
}

impl Real for F64x8 {
    type Mask = Mask8;
    const SIGNIFICAND: u32 = f64::MANTISSA_DIGITS;
    const SMALLEST: f64 = f64::SMALLEST;

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
    fn times_plus(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
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

impl Float for F64x8 {
    type Bits = U64x8;
    type One = f64;
    type Single = F32x16;
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
    fn one(value: f64) -> f64 {
        value
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
    fn equal(self, other: Self) -> Mask8 {
        Mask8(op!(_mm512_cmp_pd_mask::<_CMP_EQ_OQ>(self.0, other.0)))
    }
    // As the processor does it where one is NaN: the second.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self(op!(_mm512_max_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self(op!(_mm512_min_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn least(self) -> f64 {
        op!(_mm512_reduce_min_pd(self.0))
    }
    #[inline(always)]
    fn about_times_plus(self, factor: Self, addend: Self) -> Self {
        Self(op!(_mm512_fmadd_pd(self.0, factor.0, addend.0)))
    }
    // As words without a sign, distances have the same order, and negative ones and NaN come behind infinity.
    #[inline(always)]
    fn ahead(near: Self, far: Self) -> Self {
        near.sooner(far)
    }
    #[inline(always)]
    fn sooner(self, other: Self) -> Self {
        let bits = op!(_mm512_min_epu64(_mm512_castpd_si512(self.0), _mm512_castpd_si512(other.0)));
        Self(op!(_mm512_castsi512_pd(bits)))
    }
    #[inline(always)]
    fn later(self, other: Self) -> Self {
        let bits = op!(_mm512_max_epu64(_mm512_castpd_si512(self.0), _mm512_castpd_si512(other.0)));
        Self(op!(_mm512_castsi512_pd(bits)))
    }
    #[inline(always)]
    fn is_sooner(self, other: Self) -> Mask8 {
        Mask8(op!(_mm512_cmplt_epu64_mask(_mm512_castpd_si512(self.0), _mm512_castpd_si512(other.0))))
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
    fn rows(table: &Table, rows: Self) -> [Self; 4] {
        if let Some(columns) = &table.columns {
            let index = op!(_mm512_cvttpd_epi64(rows.0));
            let [a, b, c, d] = columns;
            return [entries(a, index), entries(b, index), entries(c, index), entries(d, index)];
        }
        let mut n = [0; 8];
        op!(_mm256_storeu_si256(n.as_mut_ptr().cast(), _mm512_cvttpd_epi32(rows.0)));
        let a = pair(table.row(n[0]), table.row(n[4]));
        let b = pair(table.row(n[1]), table.row(n[5]));
        let c = pair(table.row(n[2]), table.row(n[6]));
        let d = pair(table.row(n[3]), table.row(n[7]));
        // The transpose of four by four, in each half of the register.
        op!({
            let (ab0, ab1) = (_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b));
            let (cd0, cd1) = (_mm512_unpacklo_pd(c, d), _mm512_unpackhi_pd(c, d));
            let lower = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
            let upper = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
            [
                Self(_mm512_permutex2var_pd(ab0, lower, cd0)),
                Self(_mm512_permutex2var_pd(ab1, lower, cd1)),
                Self(_mm512_permutex2var_pd(ab0, upper, cd0)),
                Self(_mm512_permutex2var_pd(ab1, upper, cd1)),
            ]
        })
    }
}

/// Entries of a column by their numbers.
#[inline(always)]
fn entries(column: &[f64; 16], index: __m512i) -> F64x8 {
    let (low, high) = (F64x8::load(&column[..8]), F64x8::load(&column[8..]));
    F64x8(op!(_mm512_permutex2var_pd(low.0, index, high.0)))
}

/// Two rows in one register.
#[inline(always)]
fn pair(lower: &[f64; 4], upper: &[f64; 4]) -> __m512d {
    op!({
        let lower = _mm512_castpd256_pd512(_mm256_loadu_pd(lower.as_ptr()));
        _mm512_insertf64x4::<1>(lower, _mm256_loadu_pd(upper.as_ptr()))
    })
}
