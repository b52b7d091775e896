//! Single precision: eight numbers in a register.

use super::{F64x4, Mask8, U64x4, narrowed};
use crate::math::{Bits, Real};
use crate::simd::two::Two;
use crate::simd::{Float, Mask, Table};
use std::arch::x86_64::{
    __m256, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm_loadu_ps, _mm256_add_ps, _mm256_and_ps, _mm256_andnot_ps,
    _mm256_blendv_ps, _mm256_castps128_ps256, _mm256_cmp_ps, _mm256_cvtepi32_ps, _mm256_cvtpd_ps, _mm256_cvttps_epi32,
    _mm256_div_ps, _mm256_fmadd_ps, _mm256_insertf128_ps, _mm256_loadu_ps, _mm256_loadu_si256, _mm256_max_ps,
    _mm256_min_ps, _mm256_mul_ps, _mm256_or_ps, _mm256_permutevar8x32_ps, _mm256_set1_ps, _mm256_shuffle_ps,
    _mm256_sqrt_ps, _mm256_storeu_ps, _mm256_storeu_si256, _mm256_sub_ps, _mm256_unpackhi_ps, _mm256_unpacklo_ps,
    _mm256_xor_ps,
};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Eight numbers.
#[derive(Clone, Copy)]
pub(in crate::simd) struct F32x8(__m256);

operator!(F32x8: Add add _mm256_add_ps, Sub sub _mm256_sub_ps, Mul mul _mm256_mul_ps, Div div _mm256_div_ps);

impl Neg for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(op!(_mm256_xor_ps(self.0, _mm256_set1_ps(-0.0))))
    }
}

impl Real for F32x8 {
    type Mask = Mask8;
    const SIGNIFICAND: u32 = f32::MANTISSA_DIGITS;
    const SMALLEST: f64 = f32::SMALLEST;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(op!(_mm256_set1_ps(value as f32)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(op!(_mm256_sqrt_ps(self.0)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(op!(_mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0)))
    }
    #[inline(always)]
    fn times_plus(self, factor: Self, addend: Self) -> Self {
        Self(op!(_mm256_fmadd_ps(self.0, factor.0, addend.0)))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let bit = op!(_mm256_and_ps(_mm256_set1_ps(-0.0), sign.0));
        Self(op!(_mm256_or_ps(self.abs().0, bit)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        Mask8(op!(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        Mask8(op!(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(op!(_mm256_blendv_ps(no.0, yes.0, mask.0)))
    }
}

impl Float for F32x8 {
    type Bits = Two<U64x4>;
    type One = f32;
    type Single = Self;
    const LANES: usize = 8;

    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        assert!(from.len() >= 8);
        Self(op!(_mm256_loadu_ps(from.as_ptr())))
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        assert!(to.len() >= 8);
        op!(_mm256_storeu_ps(to.as_mut_ptr(), self.0));
    }
    #[inline(always)]
    fn fill(self, mask: Mask8, from: &[f32]) -> Self {
        let order = &SPREAD[mask.bits() as usize & 255];
        let next = op!(_mm256_permutevar8x32_ps(Self::load(from).0, _mm256_loadu_si256(order.as_ptr().cast())));
        Self::select(mask, Self(next), self)
    }
    #[inline(always)]
    fn one(value: f64) -> f32 {
        value as f32
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        let mut all = [0.0; 8];
        self.store(&mut all);
        f64::from(all[lane])
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        let mut all = [0.0; 8];
        self.store(&mut all);
        all[lane] = value as f32;
        *self = Self::load(&all);
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Mask8 {
        Mask8(op!(_mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, other.0)))
    }
    // As the processor does it where one is NaN: the second.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self(op!(_mm256_max_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self(op!(_mm256_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn number(bits: Two<U64x4>) -> Self {
        op!({
            let lower = _mm256_cvtpd_ps(F64x4::number(bits.0).0);
            let upper = _mm256_cvtpd_ps(F64x4::number(bits.1).0);
            Self(_mm256_insertf128_ps::<1>(_mm256_castps128_ps256(lower), upper))
        })
    }
    #[inline(always)]
    fn unit(bits: Two<U64x4>) -> Self {
        let bits = bits.down::<40>();
        Self(op!(_mm256_cvtepi32_ps(narrowed(bits.0.0, bits.1.0)))) * Self::splat(1.0 / 16_777_216.0)
    }
    #[inline(always)]
    fn rows(table: &Table, rows: Self) -> [Self; 4] {
        let mut n = [0; 8];
        op!(_mm256_storeu_si256(n.as_mut_ptr().cast(), _mm256_cvttps_epi32(rows.0)));
        let a = pair(table.single_row(n[0]), table.single_row(n[4]));
        let b = pair(table.single_row(n[1]), table.single_row(n[5]));
        let c = pair(table.single_row(n[2]), table.single_row(n[6]));
        let d = pair(table.single_row(n[3]), table.single_row(n[7]));
        // The transpose of four by four, in each half of the register.
        op!({
            let (ab0, ab1) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
            let (cd0, cd1) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
            [
                Self(_mm256_shuffle_ps::<0b01_00_01_00>(ab0, cd0)),
                Self(_mm256_shuffle_ps::<0b11_10_11_10>(ab0, cd0)),
                Self(_mm256_shuffle_ps::<0b01_00_01_00>(ab1, cd1)),
                Self(_mm256_shuffle_ps::<0b11_10_11_10>(ab1, cd1)),
            ]
        })
    }
}

/// Two rows in one register.
#[inline(always)]
fn pair(lower: &[f32; 4], upper: &[f32; 4]) -> __m256 {
    op!({
        let lower = _mm256_castps128_ps256(_mm_loadu_ps(lower.as_ptr()));
        _mm256_insertf128_ps::<1>(lower, _mm_loadu_ps(upper.as_ptr()))
    })
}

/// For each mask, the numbers that its lanes take: the first lane that it holds the first number, and so on.
static SPREAD: [[i32; 8]; 256] = {
    let (mut table, mut mask) = ([[0; 8]; 256], 0);
    while mask < 256 {
        let (mut lane, mut next) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 == 1 {
                table[mask][lane] = next;
                next += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};
