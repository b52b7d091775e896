//! Single precision: sixteen numbers in a register.

use super::{F64x8, Mask16, U32x16, U64x8, x86};
use crate::simd::pair::Pair;
use crate::simd::{Float, Table};
use pathmark_tracer::math::{Bits, Real};

register! {
    F32x16(x86::__m512) = 16 f32, Mask16, Pair<U64x8>, U32x16, Self;
    splat _mm512_set1_ps, load _mm512_loadu_ps, store _mm512_storeu_ps,
    add _mm512_add_ps, sub _mm512_sub_ps, mul _mm512_mul_ps, div _mm512_div_ps, sqrt _mm512_sqrt_ps;
    neg(x) = x86::_mm512_xor_ps(x, x86::_mm512_set1_ps(-0.0));
    abs(x) = x86::_mm512_abs_ps(x);
    copysign(x, sign) = {
        // Bit by bit: the sign's bit where `first` is set, else the magnitude's.
        let first = x86::_mm512_castps_si512(x86::_mm512_set1_ps(-0.0));
        let (x, sign) = (x86::_mm512_castps_si512(x), x86::_mm512_castps_si512(sign));
        x86::_mm512_castsi512_ps(x86::_mm512_ternarylogic_epi32::<0xCA>(first, sign, x))
    };
    fused(x, factor, addend) = x86::_mm512_fmadd_ps(x, factor, addend);
    lt(x, y) = x86::_mm512_cmp_ps_mask::<{ x86::_CMP_LT_OQ }>(x, y);
    le(x, y) = x86::_mm512_cmp_ps_mask::<{ x86::_CMP_LE_OQ }>(x, y);
    equal(x, y) = x86::_mm512_cmp_ps_mask::<{ x86::_CMP_EQ_OQ }>(x, y);
    // The second if either is NaN.
    larger(x, y) = x86::_mm512_max_ps(x, y);
    smaller(x, y) = x86::_mm512_min_ps(x, y);
    select(mask, yes, no) = x86::_mm512_mask_blend_ps(mask, no, yes);
    own {
        fn fill(self, mask: Mask16, from: &[f32]) -> Self {
            Self(op!(x86::_mm512_mask_expand_ps(self.0, mask.0, Self::load(from).0)))
        }
        fn set_lane(&mut self, lane: usize, value: f64) {
            self.0 = op!(x86::_mm512_mask_mov_ps(self.0, 1 << lane, x86::_mm512_set1_ps(value as f32)));
        }
        fn least(self) -> f64 {
            f64::from(op!(x86::_mm512_reduce_min_ps(self.0)))
        }
        fn number(bits: Pair<U64x8>) -> Self {
            op!({
                let lower = x86::_mm256_castps_pd(x86::_mm512_cvtpd_ps(F64x8::number(bits.0).0));
                let upper = x86::_mm256_castps_pd(x86::_mm512_cvtpd_ps(F64x8::number(bits.1).0));
                let both = x86::_mm512_insertf64x4::<1>(x86::_mm512_castpd256_pd512(lower), upper);
                Self(x86::_mm512_castpd_ps(both))
            })
        }
        fn unit(bits: Pair<U64x8>) -> Self {
            let [_, upper] = Self::halves(bits);
            leading(upper)
        }
        fn halves(bits: Pair<U64x8>) -> [U32x16; 2] {
            op!({
                let lower = x86::_mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
                let upper = x86::_mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
                [
                    U32x16(x86::_mm512_permutex2var_epi32(bits.0.0, lower, bits.1.0)),
                    U32x16(x86::_mm512_permutex2var_epi32(bits.0.0, upper, bits.1.0)),
                ]
            })
        }
        fn choose_digits(mask: Mask16, yes: U32x16, no: U32x16) -> U32x16 {
            U32x16(op!(x86::_mm512_mask_blend_epi32(mask.0, no.0, yes.0)))
        }
        fn fraction(digits: U32x16) -> Self {
            leading(digits.reversed())
        }
        fn rows(table: &Table, rows: Self) -> [Self; 4] {
            if let Some(columns) = &table.single_columns {
                let index = op!(x86::_mm512_cvttps_epi32(rows.0));
                let [a, b, c, d] = columns;
                return [entries(a, index), entries(b, index), entries(c, index), entries(d, index)];
            }
            let mut n = [0; 16];
            op!(x86::_mm512_storeu_si512(n.as_mut_ptr().cast(), x86::_mm512_cvttps_epi32(rows.0)));
            let a = four(table, [n[0], n[4], n[8], n[12]]);
            let b = four(table, [n[1], n[5], n[9], n[13]]);
            let c = four(table, [n[2], n[6], n[10], n[14]]);
            let d = four(table, [n[3], n[7], n[11], n[15]]);
            // The transpose of four by four, in each quarter of the register.
            op!({
                let (ab0, ab1) = (x86::_mm512_unpacklo_ps(a, b), x86::_mm512_unpackhi_ps(a, b));
                let (cd0, cd1) = (x86::_mm512_unpacklo_ps(c, d), x86::_mm512_unpackhi_ps(c, d));
                [
                    Self(x86::_mm512_shuffle_ps::<0b01_00_01_00>(ab0, cd0)),
                    Self(x86::_mm512_shuffle_ps::<0b11_10_11_10>(ab0, cd0)),
                    Self(x86::_mm512_shuffle_ps::<0b01_00_01_00>(ab1, cd1)),
                    Self(x86::_mm512_shuffle_ps::<0b11_10_11_10>(ab1, cd1)),
                ]
            })
        }
    }
}

/// The leading 24 bits of words as numbers in [0, 1).
#[inline(always)]
fn leading(words: U32x16) -> F32x16 {
    F32x16(op!(x86::_mm512_cvtepi32_ps(words.down::<8>().0))) * F32x16::splat(1.0 / 16_777_216.0)
}

/// Entries of a column by their numbers.
#[inline(always)]
fn entries(column: &[f32; 32], index: x86::__m512i) -> F32x16 {
    let (low, high) = (F32x16::load(&column[..16]), F32x16::load(&column[16..]));
    F32x16(op!(x86::_mm512_permutex2var_ps(low.0, index, high.0)))
}

/// Four rows in one register.
#[inline(always)]
fn four(table: &Table, numbers: [i32; 4]) -> x86::__m512 {
    let [a, b, c, d] = [
        table.single_row_start(numbers[0]),
        table.single_row_start(numbers[1]),
        table.single_row_start(numbers[2]),
        table.single_row_start(numbers[3]),
    ];
    op!({
        let first = x86::_mm512_castps128_ps512(x86::_mm_loadu_ps(a));
        let second = x86::_mm512_insertf32x4::<1>(first, x86::_mm_loadu_ps(b));
        let third = x86::_mm512_insertf32x4::<2>(second, x86::_mm_loadu_ps(c));
        x86::_mm512_insertf32x4::<3>(third, x86::_mm_loadu_ps(d))
    })
}
