//! Numbers of neighbouring pixels taken together, as a battery of tests of generators sees them: R14.
//!
//! Two orders, both of which an image uses: all draws of a pixel and then the next pixel's, and one draw of all pixels and then the next
//! draw.

use super::first;
use crate::check::chi_square::{against, critical, even};
use crate::check::samplers::keyed;
use crate::check::{Case, Trials};
use crate::sampling::Purpose;

pub(super) const CASES: &[Case] = &[Case {
    id: "R14",
    tries: "streams of pixels, interleaved: bytes, pairs, bits, birthdays and ranks",
    run: battery,
}];

/// Draws of a pixel.
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

/// Each of the leading six bytes.
fn bytes(numbers: &[u64]) -> f64 {
    let mut cells = vec![0; 6 * 256];
    for number in numbers {
        (0..6).for_each(|byte| cells[256 * byte + (number >> (45 - 8 * byte) & 0xFF) as usize] += 1);
    }
    let scores: f64 = cells.chunks(256).map(even).sum();
    scores / 6.0_f64.sqrt()
}

/// The first bytes of two in a row.
fn pairs(numbers: &[u64]) -> f64 {
    let mut cells = vec![0; 1 << 16];
    numbers.chunks_exact(2).for_each(|two| cells[(two[0] >> 45 << 8 | two[1] >> 45) as usize] += 1);
    even(&cells)
}

fn single_bits(numbers: &[u64]) -> f64 {
    let n = numbers.len() as f64;
    let score = |bit: u32| {
        let ones = numbers.iter().filter(|number| **number >> bit & 1 == 1).count() as f64;
        (2.0 * ones - n) / n.sqrt()
    };
    (0..53).map(score).fold(0.0, |worst: f64, z| if z.abs() > worst.abs() { z } else { worst })
}

/// Marsaglia's birthday spacings: of 4096 birthdays in a year of 2^32 days the spacings have 4096³/2^34 = 4 repetitions on average.
fn birthdays(numbers: &[u64]) -> f64 {
    let mut repeated = 0.0;
    let groups = numbers.chunks_exact(4096);
    let expected = 4.0 * groups.len() as f64;
    for group in groups {
        let mut days: Vec<u32> = group.iter().map(|number| (number >> 21) as u32).collect();
        days.sort_unstable();
        let mut spacings: Vec<u32> = days.windows(2).map(|two| two[1] - two[0]).collect();
        spacings.sort_unstable();
        repeated += spacings.windows(2).filter(|two| two[0] == two[1]).count() as f64;
    }
    (repeated - expected) / expected.sqrt()
}

/// How many of 32 rows of bits are independent.
fn rank(mut rows: [u32; 32]) -> usize {
    let mut rank = 0;
    for column in 0..32 {
        let Some(pivot) = (rank..32).find(|row| rows[*row] >> column & 1 == 1) else { continue };
        rows.swap(rank, pivot);
        let own = rows[rank];
        rows[rank + 1..].iter_mut().filter(|row| **row >> column & 1 == 1).for_each(|row| *row ^= own);
        rank += 1;
    }
    rank
}

/// Of random matrices of 32 by 32 bits 28.88 % have full rank and 57.76 % one less.
fn ranks(numbers: &[u64]) -> f64 {
    let mut cells = [0.0; 3];
    for group in numbers.chunks_exact(32) {
        let rows = std::array::from_fn(|row| (group[row] >> 21) as u32);
        cells[(32 - rank(rows)).min(2)] += 1.0;
    }
    let n: f64 = cells.iter().sum();
    against(&cells, &[0.288_788_095_2 * n, 0.577_576_190_2 * n, 0.133_635_714_6 * n])
}
