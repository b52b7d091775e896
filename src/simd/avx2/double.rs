//! Double precision: four numbers in a register.

use super::single::F32x8;
use super::{Mask4, U64x4, spread};
use crate::math::{Bits, Real};
use crate::simd::{Float, Table};
use std::arch::x86_64::{
    __m256d, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm_storeu_si128, _mm256_add_pd, _mm256_and_pd, _mm256_andnot_pd,
    _mm256_blend_epi32, _mm256_blendv_pd, _mm256_castpd_si256, _mm256_castsi256_pd, _mm256_cmp_pd, _mm256_cvttpd_epi32,
    _mm256_div_pd, _mm256_fmadd_pd, _mm256_loadu_pd, _mm256_max_pd, _mm256_min_pd, _mm256_mul_pd, _mm256_or_pd,
    _mm256_or_si256, _mm256_permute2f128_pd, _mm256_set1_pd, _mm256_sqrt_pd, _mm256_srli_epi64, _mm256_storeu_pd,
    _mm256_sub_pd, _mm256_unpackhi_pd, _mm256_unpacklo_pd, _mm256_xor_pd,
};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Four numbers.
#[derive(Clone, Copy)]
pub(in crate::simd) struct F64x4(pub(super) __m256d);

operator!(F64x4: Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd, Div div _mm256_div_pd);
impl Neg for F64x4 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(op!(_mm256_xor_pd(self.0, _mm256_set1_pd(-0.0))))
    }
}

impl Real for F64x4 {
    type Mask = Mask4;
    const SIGNIFICAND: u32 = f64::MANTISSA_DIGITS;
    const SMALLEST: f64 = f64::SMALLEST;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(op!(_mm256_set1_pd(value)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(op!(_mm256_sqrt_pd(self.0)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(op!(_mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0)))
    }
    #[inline(always)]
    fn times_plus(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let bit = op!(_mm256_and_pd(_mm256_set1_pd(-0.0), sign.0));
        Self(op!(_mm256_or_pd(self.abs().0, bit)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Mask4 {
        Mask4(op!(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Mask4 {
        Mask4(op!(_mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn select(mask: Mask4, yes: Self, no: Self) -> Self {
        Self(op!(_mm256_blendv_pd(no.0, yes.0, mask.0)))
    }
}

impl Float for F64x4 {
    type Bits = U64x4;
    type One = f64;
    type Single = F32x8;
    const LANES: usize = 4;

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        assert!(from.len() >= 4);
        Self(op!(_mm256_loadu_pd(from.as_ptr())))
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        assert!(to.len() >= 4);
        op!(_mm256_storeu_pd(to.as_mut_ptr(), self.0));
    }
    #[inline(always)]
    fn fill(self, mask: Mask4, from: &[f64]) -> Self {
        let next = op!(_mm256_castpd_si256(Self::load(from).0));
        Self::select(mask, Self(op!(_mm256_castsi256_pd(spread(mask, next)))), self)
    }
    #[inline(always)]
    fn one(value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        let mut all = [0.0; 4];
        op!(_mm256_storeu_pd(all.as_mut_ptr(), self.0));
        all[lane]
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        let mut all = [0.0; 4];
        op!(_mm256_storeu_pd(all.as_mut_ptr(), self.0));
        all[lane] = value;
        self.0 = op!(_mm256_loadu_pd(all.as_ptr()));
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Mask4 {
        Mask4(op!(_mm256_cmp_pd::<_CMP_EQ_OQ>(self.0, other.0)))
    }
    // As the processor does it where one is NaN: the second.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self(op!(_mm256_max_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self(op!(_mm256_min_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn about_times_plus(self, factor: Self, addend: Self) -> Self {
        Self(op!(_mm256_fmadd_pd(self.0, factor.0, addend.0)))
    }
    #[inline(always)]
    fn sooner(self, other: Self) -> Self {
        Self(op!(_mm256_min_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn later(self, other: Self) -> Self {
        Self(op!(_mm256_max_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn number(bits: U64x4) -> Self {
        // Halves as the lowest digits of 2^84 and of 2^52; what is then taken away was added by that.
        op!({
            let high = _mm256_or_si256(_mm256_srli_epi64::<32>(bits.0), _mm256_castpd_si256(_mm256_set1_pd(TWO_84)));
            let low = _mm256_blend_epi32::<0b1010_1010>(bits.0, _mm256_castpd_si256(_mm256_set1_pd(TWO_52)));
            let high = _mm256_sub_pd(_mm256_castsi256_pd(high), _mm256_set1_pd(TWO_84 + TWO_52));
            Self(_mm256_add_pd(high, _mm256_castsi256_pd(low)))
        })
    }
    #[inline(always)]
    fn unit(bits: U64x4) -> Self {
        Self::number(bits.down::<11>()) * Self::splat(1.0 / 9_007_199_254_740_992.0)
    }
    #[inline(always)]
    fn rows(table: &Table, rows: Self) -> [Self; 4] {
        let mut numbers = [0; 4];
        op!(_mm_storeu_si128(numbers.as_mut_ptr().cast(), _mm256_cvttpd_epi32(rows.0)));
        op!({
            let a = _mm256_loadu_pd(table.row(numbers[0]).as_ptr());
            let b = _mm256_loadu_pd(table.row(numbers[1]).as_ptr());
            let c = _mm256_loadu_pd(table.row(numbers[2]).as_ptr());
            let d = _mm256_loadu_pd(table.row(numbers[3]).as_ptr());
            // The transpose of four by four.
            let (ab0, ab1) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
            let (cd0, cd1) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
            [
                Self(_mm256_permute2f128_pd::<0x20>(ab0, cd0)),
                Self(_mm256_permute2f128_pd::<0x20>(ab1, cd1)),
                Self(_mm256_permute2f128_pd::<0x31>(ab0, cd0)),
                Self(_mm256_permute2f128_pd::<0x31>(ab1, cd1)),
            ]
        })
    }
}

const TWO_52: f64 = 4_503_599_627_370_496.0;
const TWO_84: f64 = 19_342_813_113_834_066_795_298_816.0;
