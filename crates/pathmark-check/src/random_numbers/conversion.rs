//! Conversion of bits to numbers below 1: R10.

use super::first;
use super::unguarded::{unit_in_f32, unit_of_all_bits};
use crate::samplers::keyed;
use crate::sampling::{Purpose, unit};
use crate::{Case, Trials};

pub(super) const CASES: &[Case] =
    &[Case { id: "R10", tries: "the topmost and the lowest 2^20 integers as numbers: never 1", run: below_one }];

/// Multiplying all 64 bits, or 32 bits in single precision, rounds the largest integers up to 1. The top 53 bits as a
/// multiple of 2^-53 stay below.
fn below_one(trials: &mut Trials) {
    let n = trials.times(1 << 20, 1 << 26);
    let outside =
        (0..n).filter(|k| !(0.0..1.0).contains(&unit(*k)) || !(0.0..1.0).contains(&unit(u64::MAX - k))).count();
    trials.never("53 bits, both ends", "numbers outside of [0, 1)", outside as u64, 2 * n);
    trials.close("53 bits, the largest", 1.0 - 0.5 * f64::EPSILON, unit(u64::MAX), 0.0);
    trials.close("53 bits, the smallest above 0", 0.5 * f64::EPSILON, unit(1 << 11), 0.0);
    let ones = (0..1 << 20).filter(|k| unit_in_f32(u32::MAX - k) >= 1.0).count();
    trials.same("32 bits in f32: integers that become 1", &128, &ones);
    trials.same(
        "32 bits in f32: the first of them",
        &(true, false),
        &(unit_in_f32(0xFFFF_FF80) == 1.0, unit_in_f32(0xFFFF_FF7F) == 1.0),
    );
    let ones = (0..1 << 20).filter(|k| unit_of_all_bits(u64::MAX - k) >= 1.0).count();
    trials.same("64 bits in f64: integers that become 1", &1024, &ones);
    trials.same("0.99999999 in f32", &1.0, &(0.999_999_99_f64 as f32));
    for (name, sampler) in keyed() {
        let mut outside = 0;
        let tried = trials.times(50_000, 5_000_000) as u32;
        for k in 0..tried {
            for (sample, purpose) in [(k, Purpose::Film), (u32::MAX - k, Purpose::Bsdf)] {
                let numbers = first(&*sampler, u64::from(k), !k, sample, (k as u16, purpose));
                outside += u64::from(!numbers.iter().all(|u| (0.0..1.0).contains(u)));
            }
        }
        trials.never(
            format!("{name}, first and last samples"),
            "numbers outside of [0, 1)",
            outside,
            2 * u64::from(tried),
        );
    }
}
