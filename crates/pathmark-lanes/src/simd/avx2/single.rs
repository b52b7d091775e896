//! Single precision: eight numbers in a register.

use super::{F64x4, LOWER, Mask8, U32x8, U64x4, UPPER, narrowed, x86};
use crate::simd::pair::Pair;
use crate::simd::register::with_lane;
use crate::simd::{Float, Mask, Table};
use pathmark_tracer::math::{Bits, Real};

register! {
    F32x8(x86::__m256) = 8 f32, Mask8, Pair<U64x4>, U32x8, Self;
    splat _mm256_set1_ps, load _mm256_loadu_ps, store _mm256_storeu_ps,
    add _mm256_add_ps, sub _mm256_sub_ps, mul _mm256_mul_ps, div _mm256_div_ps, sqrt _mm256_sqrt_ps;
    neg(x) = x86::_mm256_xor_ps(x, x86::_mm256_set1_ps(-0.0));
    abs(x) = x86::_mm256_andnot_ps(x86::_mm256_set1_ps(-0.0), x);
    copysign(x, sign) = {
        let zero = x86::_mm256_set1_ps(-0.0);
        x86::_mm256_or_ps(x86::_mm256_andnot_ps(zero, x), x86::_mm256_and_ps(zero, sign))
    };
    fused(x, factor, addend) = x86::_mm256_fmadd_ps(x, factor, addend);
    lt(x, y) = x86::_mm256_cmp_ps::<{ x86::_CMP_LT_OQ }>(x, y);
    le(x, y) = x86::_mm256_cmp_ps::<{ x86::_CMP_LE_OQ }>(x, y);
    equal(x, y) = x86::_mm256_cmp_ps::<{ x86::_CMP_EQ_OQ }>(x, y);
    // The second if either is NaN.
    larger(x, y) = x86::_mm256_max_ps(x, y);
    smaller(x, y) = x86::_mm256_min_ps(x, y);
    select(mask, yes, no) = x86::_mm256_blendv_ps(no, yes, mask);
    own {
        fn fill(self, mask: Mask8, from: &[f32]) -> Self {
            let order = SPREAD[mask.bits() as usize & 255].as_ptr();
            let next =
                op!(x86::_mm256_permutevar8x32_ps(Self::load(from).0, x86::_mm256_loadu_si256(order.cast())));
            Self::select(mask, Self(next), self)
        }
        fn least(self) -> f64 {
            let halves = op!(x86::_mm_min_ps(x86::_mm256_castps256_ps128(self.0), x86::_mm256_extractf128_ps::<1>(self.0)));
            let pairs = op!(x86::_mm_min_ps(halves, x86::_mm_movehl_ps(halves, halves)));
            let both = op!(x86::_mm_min_ss(pairs, x86::_mm_shuffle_ps::<1>(pairs, pairs)));
            f64::from(op!(x86::_mm_cvtss_f32(both)))
        }
        fn set_lane(&mut self, lane: usize, value: f64) {
            *self = with_lane::<Self, 8>(*self, lane, value);
        }
        fn number(bits: Pair<U64x4>) -> Self {
            op!({
                let lower = x86::_mm256_cvtpd_ps(F64x4::number(bits.0).0);
                let upper = x86::_mm256_cvtpd_ps(F64x4::number(bits.1).0);
                Self(x86::_mm256_insertf128_ps::<1>(x86::_mm256_castps128_ps256(lower), upper))
            })
        }
        fn unit(bits: Pair<U64x4>) -> Self {
            let [_, upper] = Self::halves(bits);
            leading(upper)
        }
        fn halves(bits: Pair<U64x4>) -> [U32x8; 2] {
            let (lower, upper) = (bits.0.0, bits.1.0);
            [U32x8(narrowed::<LOWER>(lower, upper)), U32x8(narrowed::<UPPER>(lower, upper))]
        }
        fn choose_digits(mask: Mask8, yes: U32x8, no: U32x8) -> U32x8 {
            U32x8(op!(x86::_mm256_blendv_epi8(no.0, yes.0, x86::_mm256_castps_si256(mask.0))))
        }
        fn fraction(digits: U32x8) -> Self {
            leading(digits.reversed())
        }
        fn rows(table: &Table, rows: Self) -> [Self; 4] {
            let mut n = [0; 8];
            op!(x86::_mm256_storeu_si256(n.as_mut_ptr().cast(), x86::_mm256_cvttps_epi32(rows.0)));
            let a = pair(table, n[0], n[4]);
            let b = pair(table, n[1], n[5]);
            let c = pair(table, n[2], n[6]);
            let d = pair(table, n[3], n[7]);
            // The transpose of four by four, in each half of the register.
            op!({
                let (ab0, ab1) = (x86::_mm256_unpacklo_ps(a, b), x86::_mm256_unpackhi_ps(a, b));
                let (cd0, cd1) = (x86::_mm256_unpacklo_ps(c, d), x86::_mm256_unpackhi_ps(c, d));
                [
                    Self(x86::_mm256_shuffle_ps::<0b01_00_01_00>(ab0, cd0)),
                    Self(x86::_mm256_shuffle_ps::<0b11_10_11_10>(ab0, cd0)),
                    Self(x86::_mm256_shuffle_ps::<0b01_00_01_00>(ab1, cd1)),
                    Self(x86::_mm256_shuffle_ps::<0b11_10_11_10>(ab1, cd1)),
                ]
            })
        }
    }
}

/// The leading 24 bits of words as numbers in [0, 1).
#[inline(always)]
fn leading(words: U32x8) -> F32x8 {
    F32x8(op!(x86::_mm256_cvtepi32_ps(words.down::<8>().0))) * F32x8::splat(1.0 / 16_777_216.0)
}

/// Two rows in one register.
#[inline(always)]
fn pair(table: &Table, lower: i32, upper: i32) -> x86::__m256 {
    op!({
        let lower = x86::_mm256_castps128_ps256(x86::_mm_loadu_ps(table.single_row_start(lower)));
        x86::_mm256_insertf128_ps::<1>(lower, x86::_mm_loadu_ps(table.single_row_start(upper)))
    })
}

/// For each mask, the indices of the numbers for its lanes: 0 for the first lane in the mask, and so on.
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
