//! Double precision: eight numbers in a register.

use super::single::F32x16;
use super::{Mask8, U64x8, x86};
use crate::simd::{Float, Table, Words};
use pathmark_tracer::math::{Bits, Real};

register! {
    F64x8(x86::__m512d) = 8 f64, Mask8, U64x8, U64x8, F32x16;
    splat _mm512_set1_pd, load _mm512_loadu_pd, store _mm512_storeu_pd,
    add _mm512_add_pd, sub _mm512_sub_pd, mul _mm512_mul_pd, div _mm512_div_pd, sqrt _mm512_sqrt_pd;
    neg(x) = x86::_mm512_xor_pd(x, x86::_mm512_set1_pd(-0.0));
    abs(x) = x86::_mm512_abs_pd(x);
    copysign(x, sign) = {
        // Bit by bit: the sign's bit where `first` is set, else the magnitude's.
        let first = x86::_mm512_castpd_si512(x86::_mm512_set1_pd(-0.0));
        let (x, sign) = (x86::_mm512_castpd_si512(x), x86::_mm512_castpd_si512(sign));
        x86::_mm512_castsi512_pd(x86::_mm512_ternarylogic_epi64::<0xCA>(first, sign, x))
    };
    fused(x, factor, addend) = x86::_mm512_fmadd_pd(x, factor, addend);
    lt(x, y) = x86::_mm512_cmp_pd_mask::<{ x86::_CMP_LT_OQ }>(x, y);
    le(x, y) = x86::_mm512_cmp_pd_mask::<{ x86::_CMP_LE_OQ }>(x, y);
    equal(x, y) = x86::_mm512_cmp_pd_mask::<{ x86::_CMP_EQ_OQ }>(x, y);
    // The second if either is NaN.
    larger(x, y) = x86::_mm512_max_pd(x, y);
    smaller(x, y) = x86::_mm512_min_pd(x, y);
    select(mask, yes, no) = x86::_mm512_mask_blend_pd(mask, no, yes);
    own {
        fn fill(self, mask: Mask8, from: &[f64]) -> Self {
            Self(op!(x86::_mm512_mask_expand_pd(self.0, mask.0, Self::load(from).0)))
        }
        fn set_lane(&mut self, lane: usize, value: f64) {
            self.0 = op!(x86::_mm512_mask_mov_pd(self.0, 1 << lane, x86::_mm512_set1_pd(value)));
        }
        fn least(self) -> f64 {
            op!(x86::_mm512_reduce_min_pd(self.0))
        }
        // As unsigned words, distances keep their order, and negative numbers and NaN come after infinity.
        fn ahead(near: Self, far: Self) -> Self {
            near.sooner(far)
        }
        fn sooner(self, other: Self) -> Self {
            op!(Self(x86::_mm512_castsi512_pd(x86::_mm512_min_epu64(words(self), words(other)))))
        }
        fn later(self, other: Self) -> Self {
            op!(Self(x86::_mm512_castsi512_pd(x86::_mm512_max_epu64(words(self), words(other)))))
        }
        fn is_sooner(self, other: Self) -> Mask8 {
            Mask8(op!(x86::_mm512_cmplt_epu64_mask(words(self), words(other))))
        }
        fn number(bits: U64x8) -> Self {
            Self(op!(x86::_mm512_cvtepu64_pd(bits.0)))
        }
        fn unit(bits: U64x8) -> Self {
            Self::number(bits.down::<11>()) * Self::splat(1.0 / 9_007_199_254_740_992.0)
        }
        fn halves(bits: U64x8) -> [U64x8; 2] {
            [bits, bits.down::<32>()]
        }
        fn choose_digits(mask: Mask8, yes: U64x8, no: U64x8) -> U64x8 {
            U64x8::choose(mask, yes, no)
        }
        fn fraction(digits: U64x8) -> Self {
            Self::unit(digits.reversed())
        }
        fn rows(table: &Table, rows: Self) -> [Self; 4] {
            if let Some(columns) = &table.columns {
                let index = op!(x86::_mm512_cvttpd_epi64(rows.0));
                let [a, b, c, d] = columns;
                return [entries(a, index), entries(b, index), entries(c, index), entries(d, index)];
            }
            let mut n = [0; 8];
            op!(x86::_mm256_storeu_si256(n.as_mut_ptr().cast(), x86::_mm512_cvttpd_epi32(rows.0)));
            let a = pair(table, n[0], n[4]);
            let b = pair(table, n[1], n[5]);
            let c = pair(table, n[2], n[6]);
            let d = pair(table, n[3], n[7]);
            // The transpose of four by four, in each half of the register.
            op!({
                let (ab0, ab1) = (x86::_mm512_unpacklo_pd(a, b), x86::_mm512_unpackhi_pd(a, b));
                let (cd0, cd1) = (x86::_mm512_unpacklo_pd(c, d), x86::_mm512_unpackhi_pd(c, d));
                let lower = x86::_mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
                let upper = x86::_mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
                [
                    Self(x86::_mm512_permutex2var_pd(ab0, lower, cd0)),
                    Self(x86::_mm512_permutex2var_pd(ab1, lower, cd1)),
                    Self(x86::_mm512_permutex2var_pd(ab0, upper, cd0)),
                    Self(x86::_mm512_permutex2var_pd(ab1, upper, cd1)),
                ]
            })
        }
    }
}

#[inline(always)]
fn words(of: F64x8) -> x86::__m512i {
    op!(x86::_mm512_castpd_si512(of.0))
}

/// Entries of a column by their numbers.
#[inline(always)]
fn entries(column: &[f64; 16], index: x86::__m512i) -> F64x8 {
    let (low, high) = (F64x8::load(&column[..8]), F64x8::load(&column[8..]));
    F64x8(op!(x86::_mm512_permutex2var_pd(low.0, index, high.0)))
}

/// Two rows in one register.
#[inline(always)]
fn pair(table: &Table, lower: i32, upper: i32) -> x86::__m512d {
    op!({
        let lower = x86::_mm512_castpd256_pd512(x86::_mm256_loadu_pd(table.row_start(lower)));
        x86::_mm512_insertf64x4::<1>(lower, x86::_mm256_loadu_pd(table.row_start(upper)))
    })
}
