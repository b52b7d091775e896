//! Double precision: two numbers in a register.

use super::single::F32x4;
use super::{Mask2, U64x2, arm, spread};
use crate::simd::register::with_lane;
use crate::simd::{Float, Table, Words};
use pathmark_tracer::math::{Bits, Real};

register! {
    F64x2(arm::float64x2_t) = 2 f64, Mask2, U64x2, U64x2, F32x4;
    splat vdupq_n_f64, load vld1q_f64, store vst1q_f64,
    add vaddq_f64, sub vsubq_f64, mul vmulq_f64, div vdivq_f64, sqrt vsqrtq_f64;
    neg(x) = arm::vnegq_f64(x);
    abs(x) = arm::vabsq_f64(x);
    copysign(x, sign) = arm::vbslq_f64(arm::vdupq_n_u64(1 << 63), sign, x);
    fused(x, factor, addend) = arm::vfmaq_f64(addend, x, factor);
    lt(x, y) = arm::vcltq_f64(x, y);
    le(x, y) = arm::vcleq_f64(x, y);
    equal(x, y) = arm::vceqq_f64(x, y);
    larger(x, y) = arm::vbslq_f64(arm::vcgtq_f64(x, y), x, y);
    smaller(x, y) = arm::vbslq_f64(arm::vcltq_f64(x, y), x, y);
    select(mask, yes, no) = arm::vbslq_f64(mask, yes, no);
    own {
        fn halves(bits: U64x2) -> [U64x2; 2] {
            [bits, bits.down::<32>()]
        }
        fn choose_digits(mask: Mask2, yes: U64x2, no: U64x2) -> U64x2 {
            U64x2::choose(mask, yes, no)
        }
        fn fraction(digits: U64x2) -> Self {
            Self::unit(digits.reversed())
        }
        fn fill(self, mask: Mask2, from: &[f64]) -> Self {
            let next = op!(arm::vreinterpretq_u64_f64(Self::load(from).0));
            Self::select(mask, Self(op!(arm::vreinterpretq_f64_u64(spread(mask, next)))), self)
        }
        fn set_lane(&mut self, lane: usize, value: f64) {
            *self = with_lane::<Self, 2>(*self, lane, value);
        }
        fn least(self) -> f64 {
            op!(arm::vminnmvq_f64(self.0))
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
                // As in `Table::row`: the first row if there is none of that number.
                let numbers = arm::vcvtq_u64_f64(rows.0);
                let count = arm::vdupq_n_u64(table.rows.len() as u64);
                let numbers = arm::vandq_u64(numbers, arm::vcltq_u64(numbers, count));
                let start = table.rows.as_ptr();
                let a: *const f64 = start.add(arm::vgetq_lane_u64::<0>(numbers) as usize).cast();
                let b: *const f64 = start.add(arm::vgetq_lane_u64::<1>(numbers) as usize).cast();
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
