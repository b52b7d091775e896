//! Double precision: two numbers in a register.

use super::single::F32x4;
use super::{Mask2, U64x2, arm, spread};
use crate::simd::{Float, Table};
use pathmark_tracer::math::{Bits, Real};

register! {
    F64x2(float64x2_t) = 2 f64, Mask2, U64x2, F32x4;
    splat vdupq_n_f64, load vld1q_f64, store vst1q_f64, fused vfmaq_f64,
    add vaddq_f64, sub vsubq_f64, mul vmulq_f64, div vdivq_f64, neg vnegq_f64, abs vabsq_f64,
    sqrt vsqrtq_f64, least vminnmvq_f64, lt vcltq_f64, le vcleq_f64, equal vceqq_f64, select vbslq_f64;
    sign = arm::vdupq_n_u64(1 << 63);
    own {
        fn fill(self, mask: Mask2, from: &[f64]) -> Self {
            let next = op!(arm::vreinterpretq_u64_f64(Self::load(from).0));
            Self::select(mask, Self(op!(arm::vreinterpretq_f64_u64(spread(mask, next)))), self)
        }
        fn pack(self, mask: Mask2, to: &mut [f64]) {
            let is_first_wanted = op!(arm::vdupq_laneq_u64::<0>(mask.0));
            let second = Self(op!(arm::vdupq_laneq_f64::<1>(self.0)));
            Self::select(Mask2(is_first_wanted), self, second).store(to);
        }
        // As unsigned words, distances keep their order, and negative numbers and NaN come after infinity.
        fn ahead(near: Self, far: Self) -> Self {
            near.sooner(far)
        }
        fn sooner(self, other: Self) -> Self {
            Self::select(other.is_sooner(self), other, self)
        }
        fn later(self, other: Self) -> Self {
            Self::select(other.is_sooner(self), self, other)
        }
        fn is_sooner(self, other: Self) -> Mask2 {
            Mask2(op!(arm::vcltq_u64(arm::vreinterpretq_u64_f64(self.0), arm::vreinterpretq_u64_f64(other.0))))
        }
        fn number(bits: U64x2) -> Self {
            Self(op!(arm::vcvtq_f64_u64(bits.0)))
        }
        fn unit(bits: U64x2) -> Self {
            Self(op!(arm::vcvtq_n_f64_u64::<53>(bits.down::<11>().0)))
        }
        fn rows(table: &Table, rows: Self) -> [Self; 4] {
            op!({
                let numbers = arm::vcvtq_s64_f64(rows.0);
                let a = table.row_start(arm::vgetq_lane_s64::<0>(numbers) as i32);
                let b = table.row_start(arm::vgetq_lane_s64::<1>(numbers) as i32);
                let [a0, b0] = [arm::vld1q_f64(a), arm::vld1q_f64(b)];
                let [a1, b1] = [arm::vld1q_f64(a.add(2)), arm::vld1q_f64(b.add(2))];
                // The transpose of two by four.
                [
                    Self(arm::vzip1q_f64(a0, b0)),
                    Self(arm::vzip2q_f64(a0, b0)),
                    Self(arm::vzip1q_f64(a1, b1)),
                    Self(arm::vzip2q_f64(a1, b1)),
                ]
            })
        }
    }
}
