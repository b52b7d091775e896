//! Double precision: four numbers in a register.

use super::single::F32x8;
use super::{Mask4, U64x4, spread, x86};
use crate::simd::register::with_lane;
use crate::simd::{Float, Table, Words};
use pathmark_tracer::math::{Bits, Real};

register! {
    F64x4(x86::__m256d) = 4 f64, Mask4, U64x4, U64x4, F32x8;
    splat _mm256_set1_pd, load _mm256_loadu_pd, store _mm256_storeu_pd,
    add _mm256_add_pd, sub _mm256_sub_pd, mul _mm256_mul_pd, div _mm256_div_pd, sqrt _mm256_sqrt_pd;
    neg(x) = x86::_mm256_xor_pd(x, x86::_mm256_set1_pd(-0.0));
    abs(x) = x86::_mm256_andnot_pd(x86::_mm256_set1_pd(-0.0), x);
    copysign(x, sign) = {
        let zero = x86::_mm256_set1_pd(-0.0);
        x86::_mm256_or_pd(x86::_mm256_andnot_pd(zero, x), x86::_mm256_and_pd(zero, sign))
    };
    fused(x, factor, addend) = x86::_mm256_fmadd_pd(x, factor, addend);
    lt(x, y) = x86::_mm256_cmp_pd::<{ x86::_CMP_LT_OQ }>(x, y);
    le(x, y) = x86::_mm256_cmp_pd::<{ x86::_CMP_LE_OQ }>(x, y);
    equal(x, y) = x86::_mm256_cmp_pd::<{ x86::_CMP_EQ_OQ }>(x, y);
    // The second if either is NaN.
    larger(x, y) = x86::_mm256_max_pd(x, y);
    smaller(x, y) = x86::_mm256_min_pd(x, y);
    select(mask, yes, no) = x86::_mm256_blendv_pd(no, yes, mask);
    own {
        fn fill(self, mask: Mask4, from: &[f64]) -> Self {
            let next = op!(x86::_mm256_castpd_si256(Self::load(from).0));
            Self::select(mask, Self(op!(x86::_mm256_castsi256_pd(spread(mask, next)))), self)
        }
        fn set_lane(&mut self, lane: usize, value: f64) {
            *self = with_lane::<Self, 4>(*self, lane, value);
        }
        fn sooner(self, other: Self) -> Self {
            self.smaller(other)
        }
        fn later(self, other: Self) -> Self {
            self.larger(other)
        }
        fn number(bits: U64x4) -> Self {
            // The halves become the lowest digits of 2^84 and of 2^52; these powers are then subtracted again.
            op!({
                let [of_high, of_low] = [Self::splat(TWO_84).0, Self::splat(TWO_52).0];
                let high = x86::_mm256_srli_epi64::<32>(bits.0);
                let high = x86::_mm256_or_si256(high, x86::_mm256_castpd_si256(of_high));
                let low = x86::_mm256_blend_epi32::<0b1010_1010>(bits.0, x86::_mm256_castpd_si256(of_low));
                let (high, low) = (Self(x86::_mm256_castsi256_pd(high)), Self(x86::_mm256_castsi256_pd(low)));
                high - Self::splat(TWO_84 + TWO_52) + low
            })
        }
        fn unit(bits: U64x4) -> Self {
            Self::number(bits.down::<11>()) * Self::splat(1.0 / 9_007_199_254_740_992.0)
        }
        fn halves(bits: U64x4) -> [U64x4; 2] {
            [bits, bits.down::<32>()]
        }
        fn choose_digits(mask: Mask4, yes: U64x4, no: U64x4) -> U64x4 {
            U64x4::choose(mask, yes, no)
        }
        fn fraction(digits: U64x4) -> Self {
            Self::unit(digits.reversed())
        }
        fn rows(table: &Table, rows: Self) -> [Self; 4] {
            let mut numbers = [0; 4];
            op!(x86::_mm_storeu_si128(numbers.as_mut_ptr().cast(), x86::_mm256_cvttpd_epi32(rows.0)));
            let (a, b) = (op!(x86::_mm256_loadu_pd(table.row_start(numbers[0]))), op!(x86::_mm256_loadu_pd(table.row_start(numbers[1]))));
            let (c, d) = (op!(x86::_mm256_loadu_pd(table.row_start(numbers[2]))), op!(x86::_mm256_loadu_pd(table.row_start(numbers[3]))));
            // The transpose of four by four.
            op!({
                let (ab0, ab1) = (x86::_mm256_unpacklo_pd(a, b), x86::_mm256_unpackhi_pd(a, b));
                let (cd0, cd1) = (x86::_mm256_unpacklo_pd(c, d), x86::_mm256_unpackhi_pd(c, d));
                [
                    Self(x86::_mm256_permute2f128_pd::<0x20>(ab0, cd0)),
                    Self(x86::_mm256_permute2f128_pd::<0x20>(ab1, cd1)),
                    Self(x86::_mm256_permute2f128_pd::<0x31>(ab0, cd0)),
                    Self(x86::_mm256_permute2f128_pd::<0x31>(ab1, cd1)),
                ]
            })
        }
    }
}

const TWO_52: f64 = 4_503_599_627_370_496.0;
const TWO_84: f64 = 19_342_813_113_834_066_795_298_816.0;
