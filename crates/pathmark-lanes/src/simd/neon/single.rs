//! Single precision: four numbers in a register.

use super::{F64x2, Mask4, U64x2, arm, split};
use crate::simd::pair::Pair;
use crate::simd::register::with_lane;
use crate::simd::{Float, Mask, Table, Words};
use pathmark_tracer::math::{Bits, Real};

register! {
    F32x4(arm::float32x4_t) = 4 f32, Mask4, Pair<U64x2>, Pair<U64x2>, Self;
    splat vdupq_n_f32, load vld1q_f32, store vst1q_f32,
    add vaddq_f32, sub vsubq_f32, mul vmulq_f32, div vdivq_f32, sqrt vsqrtq_f32;
    neg(x) = arm::vnegq_f32(x);
    abs(x) = arm::vabsq_f32(x);
    copysign(x, sign) = arm::vbslq_f32(arm::vdupq_n_u32(1 << 31), sign, x);
    fused(x, factor, addend) = arm::vfmaq_f32(addend, x, factor);
    lt(x, y) = arm::vcltq_f32(x, y);
    le(x, y) = arm::vcleq_f32(x, y);
    equal(x, y) = arm::vceqq_f32(x, y);
    larger(x, y) = arm::vbslq_f32(arm::vcgtq_f32(x, y), x, y);
    smaller(x, y) = arm::vbslq_f32(arm::vcltq_f32(x, y), x, y);
    select(mask, yes, no) = arm::vbslq_f32(mask, yes, no);
    own {
        fn halves(bits: Pair<U64x2>) -> [Pair<U64x2>; 2] {
            [bits, bits.down::<32>()]
        }
        fn choose_digits(mask: Mask4, yes: Pair<U64x2>, no: Pair<U64x2>) -> Pair<U64x2> {
            Pair::<U64x2>::choose(mask, yes, no)
        }
        fn fraction(digits: Pair<U64x2>) -> Self {
            Self::unit(digits.reversed())
        }
        fn fill(self, mask: Mask4, from: &[f32]) -> Self {
            Self::select(mask, Self::load(from).in_order(&SPREAD[mask.bits() as usize & 15]), self)
        }
        // One instruction each, for numbers of which only the first may be NaN.
        fn at_least(self, other: Self) -> Self {
            Self(op!(arm::vmaxnmq_f32(self.0, other.0)))
        }
        fn at_most(self, other: Self) -> Self {
            Self(op!(arm::vminnmq_f32(self.0, other.0)))
        }
        fn set_lane(&mut self, lane: usize, value: f64) {
            *self = with_lane::<Self, 4>(*self, lane, value);
        }
        fn least(self) -> f64 {
            op!(arm::vminnmvq_f32(self.0)).into()
        }
        fn number(bits: Pair<U64x2>) -> Self {
            op!({
                let lower = arm::vcvt_f32_f64(F64x2::number(bits.0).0);
                Self(arm::vcvt_high_f32_f64(lower, F64x2::number(bits.1).0))
            })
        }
        fn unit(bits: Pair<U64x2>) -> Self {
            op!({
                let high = arm::vuzp2q_u32(split(bits.0.0), split(bits.1.0));
                Self(arm::vcvtq_n_f32_u32::<24>(arm::vshrq_n_u32::<8>(high)))
            })
        }
        fn rows(table: &Table, rows: Self) -> [Self; 4] {
            op!({
                // As in `Table::row`: the first row if there is none of that number.
                let numbers = arm::vcvtq_u32_f32(rows.0);
                let count = arm::vdupq_n_u32(table.singles.len() as u32);
                let numbers = arm::vandq_u32(numbers, arm::vcltq_u32(numbers, count));
                let start = table.singles.as_ptr();
                let a = arm::vld1q_f32(start.add(arm::vgetq_lane_u32::<0>(numbers) as usize).cast());
                let b = arm::vld1q_f32(start.add(arm::vgetq_lane_u32::<1>(numbers) as usize).cast());
                let c = arm::vld1q_f32(start.add(arm::vgetq_lane_u32::<2>(numbers) as usize).cast());
                let d = arm::vld1q_f32(start.add(arm::vgetq_lane_u32::<3>(numbers) as usize).cast());
                // The transpose of four by four: of the numbers in pairs, then of the pairs.
                let [ab0, ab1] = [as_pairs(arm::vtrn1q_f32(a, b)), as_pairs(arm::vtrn2q_f32(a, b))];
                let [cd0, cd1] = [as_pairs(arm::vtrn1q_f32(c, d)), as_pairs(arm::vtrn2q_f32(c, d))];
                [
                    of_pairs(arm::vtrn1q_f64(ab0, cd0)),
                    of_pairs(arm::vtrn1q_f64(ab1, cd1)),
                    of_pairs(arm::vtrn2q_f64(ab0, cd0)),
                    of_pairs(arm::vtrn2q_f64(ab1, cd1)),
                ]
            })
        }
    }
}

#[inline(always)]
fn as_pairs(numbers: arm::float32x4_t) -> arm::float64x2_t {
    op!(arm::vreinterpretq_f64_f32(numbers))
}

#[inline(always)]
fn of_pairs(pairs: arm::float64x2_t) -> F32x4 {
    F32x4(op!(arm::vreinterpretq_f32_f64(pairs)))
}

impl F32x4 {
    /// The numbers in another order.
    #[inline(always)]
    fn in_order(self, order: &[u8; 16]) -> Self {
        op!({
            let bytes = arm::vqtbl1q_u8(arm::vreinterpretq_u8_f32(self.0), arm::vld1q_u8(order.as_ptr()));
            Self(arm::vreinterpretq_f32_u8(bytes))
        })
    }
}

/// For each mask, the bytes of the numbers for its lanes: the first number for the first lane in the mask, and so on.
static SPREAD: [[u8; 16]; 16] = {
    let (mut table, mut mask) = ([[0; 16]; 16], 0);
    while mask < 16 {
        let (mut lane, mut next) = (0, 0);
        while lane < 4 {
            if mask >> lane & 1 == 1 {
                put(&mut table[mask], lane, next);
                next += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// Writes the bytes of the number in lane `from` into an order, for the number in lane `to`.
const fn put(order: &mut [u8; 16], to: usize, from: usize) {
    let mut byte = 0;
    while byte < 4 {
        order[4 * to + byte] = (4 * from + byte) as u8;
        byte += 1;
    }
}
