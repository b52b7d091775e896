//! Random numbers of neighbouring pixels together, through a battery of tests for generators: R14.
//!
//! An image uses two orders, and both are tested: all draws of a pixel and then those of the next pixel, and one draw
//! of all pixels and then the next draw.

use super::first;
use crate::analysis::randomness::battery::{birthdays, bytes, pairs, ranks, single_bits};
use crate::level::critical;
use crate::samplers::keyed;
use crate::sampling::Purpose;
use crate::{Case, Trials};

pub(super) const CASES: &[Case] = &[Case {
    id: "R14",
    tries: "streams of pixels, interleaved: bytes, pairs, bits, birthdays and ranks",
    run: battery,
}];

/// The draws of a pixel.
const USES: [(u16, Purpose); 4] = [(1, Purpose::Bsdf), (2, Purpose::Bsdf), (3, Purpose::Light), (6, Purpose::Roulette)];
const DRAWS: u32 = 2 * USES.len() as u32;

/// The leading 53 bits of a number.
fn bits(u: f64) -> u64 {
    (u * 9_007_199_254_740_992.0) as u64
}

fn battery(trials: &mut Trials) {
    let pixels = trials.times(1 << 16, 1 << 21) as u32;
    let limit = critical(keyed().count() * 2 * (5 + 53));
    for (name, sampler) in keyed() {
        let pixel_major: Vec<u64> = (0..pixels)
            .flat_map(|pixel| USES.into_iter().flat_map(move |used| [(pixel, used)]))
            .flat_map(|(pixel, used)| first(&*sampler, 1, pixel, 0, used).map(bits))
            .collect();
        let draw_major: Vec<u64> = (0..DRAWS)
            .flat_map(|draw| pixel_major.iter().skip(draw as usize).step_by(DRAWS as usize).copied())
            .collect();
        for (order, numbers) in [("pixel by pixel", pixel_major), ("draw by draw", draw_major)] {
            let variant = format!("{name}, {order}");
            trials.deviates_below(format!("{variant}: bytes"), limit, bytes(&numbers));
            trials.deviates_below(format!("{variant}: pairs of bytes"), limit, pairs(&numbers));
            trials.deviates_below(format!("{variant}: worst of 53 bits"), limit, single_bits(&numbers));
            trials.deviates_below(format!("{variant}: birthdays"), limit, birthdays(&numbers));
            trials.deviates_below(format!("{variant}: ranks of matrices"), limit, ranks(&numbers));
        }
    }
    trials.skip("PractRand and TestU01, which read 1 TiB, are not part of this program");
}
