//! Single precision: four numbers in a register.

use super::{F64x2, Mask4, U64x2, arm, split};
use crate::simd::pair::Pair;
use crate::simd::{Float, Mask, Table};
use pathmark_tracer::math::Real;

register! {
    F32x4(float32x4_t) = 4 f32, Mask4, Pair<U64x2>, Self;
    splat vdupq_n_f32, load vld1q_f32, store vst1q_f32, fused vfmaq_f32,
    add vaddq_f32, sub vsubq_f32, mul vmulq_f32, div vdivq_f32, neg vnegq_f32, abs vabsq_f32,
    sqrt vsqrtq_f32, least vminnmvq_f32, lt vcltq_f32, le vcleq_f32, equal vceqq_f32, select vbslq_f32;
    sign = arm::vdupq_n_u32(1 << 31);
    own {
        fn fill(self, mask: Mask4, from: &[f32]) -> Self {
            Self::select(mask, Self::load(from).in_order(&SPREAD, mask), self)
        }
        fn pack(self, mask: Mask4, to: &mut [f32]) {
            self.in_order(&PACKED, mask).store(to);
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
                let numbers = arm::vcvtq_s32_f32(rows.0);
                let a = arm::vld1q_f32(table.single_row_start(arm::vgetq_lane_s32::<0>(numbers)));
                let b = arm::vld1q_f32(table.single_row_start(arm::vgetq_lane_s32::<1>(numbers)));
                let c = arm::vld1q_f32(table.single_row_start(arm::vgetq_lane_s32::<2>(numbers)));
                let d = arm::vld1q_f32(table.single_row_start(arm::vgetq_lane_s32::<3>(numbers)));
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
    /// The numbers in the order that a table gives for a mask.
    #[inline(always)]
    fn in_order(self, orders: &[[u8; 16]; 16], mask: Mask4) -> Self {
        let order = &orders[mask.bits() as usize & 15];
        op!({
            let bytes = arm::vqtbl1q_u8(arm::vreinterpretq_u8_f32(self.0), arm::vld1q_u8(order.as_ptr()));
            Self(arm::vreinterpretq_f32_u8(bytes))
        })
    }
}

/// For each mask, the bytes of its lanes in order.
static PACKED: [[u8; 16]; 16] = orders(true);

/// For each mask, the bytes of the numbers for its lanes: the first number for the first lane in the mask, and so on.
static SPREAD: [[u8; 16]; 16] = orders(false);

const fn orders(are_packed: bool) -> [[u8; 16]; 16] {
    let (mut table, mut mask) = ([[0; 16]; 16], 0);
    while mask < 16 {
        let (mut lane, mut next) = (0, 0);
        while lane < 4 {
            if mask >> lane & 1 == 1 {
                let (to, from) = if are_packed { (next, lane) } else { (lane, next) };
                let mut byte = 0;
                while byte < 4 {
                    table[mask][4 * to + byte] = (4 * from + byte) as u8;
                    byte += 1;
                }
                next += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
}
