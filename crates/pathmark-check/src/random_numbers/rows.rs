//! Generators seeded by row or pixel: R01, R02, R03.

use super::unguarded::{erand48, lcg_of_pixel, smallpt_row};
use super::{first, keyed, worst};
use crate::analysis::chi_square::even;
use crate::analysis::randomness::correlation;
use crate::sampling::{Address, Purpose, SampleKey};
use crate::{Trials, critical};
use std::collections::BTreeMap;

const PIXELS: u32 = 786_432;

/// The number of different values, the number of rows that share one, and the size of the largest group.
fn groups<T: Ord>(values: impl Iterator<Item = T>) -> (usize, usize, usize) {
    let mut counts = BTreeMap::new();
    for value in values {
        *counts.entry(value).or_insert(0) += 1;
    }
    let sharing: usize = counts.values().filter(|count| **count > 1).sum();
    (counts.len(), sharing, counts.values().copied().max().unwrap_or(0))
}

/// smallpt's seed is the cube of the row, which wraps at 2^16. Of 768 rows, 48 share a stream, up to 12 of them the
/// same one; of 2160 rows, 270 share one, up to 34 the same one.
pub(super) fn rows(trials: &mut Trials) {
    for (rows, expected) in [(768, (730, 48, 12)), (2160, (1964, 270, 34))] {
        trials.same(
            format!("smallpt, {rows} rows: streams, rows that share, largest group"),
            &expected,
            &groups((0..rows).map(smallpt_row)),
        );
        for (name, sampler) in keyed() {
            let first_of_row = |y: u32| first(&*sampler, 1, y * 1024, 0, (0, Purpose::Film)).map(f64::to_bits);
            trials.same(format!("{name}, {rows} rows"), &(rows as usize, 0, 1), &groups((0..rows).map(first_of_row)));
        }
    }
    trials.close("smallpt, first draw of row 0", 3.9e-14, erand48(&mut smallpt_row(0)), 1e-15);
    // The position in the pixel, in rows 64 apart, which get the same random numbers in smallpt.
    let limit = critical(keyed().count() * 12);
    for (name, sampler) in keyed() {
        let row = |y: u32| {
            (0..4096).map(|x| first(&*sampler, 1, y * 4096 + x, 0, (0, Purpose::Film))[0] - 0.5).collect::<Vec<_>>()
        };
        let zero = row(0);
        let worst = worst((1..12).map(|k| correlation(&zero, &row(64 * k))));
        trials.deviates_below(format!("{name}: rows that are multiples of 64 apart"), limit, worst);
    }
}

/// The cell, out of 64, of the difference modulo 1.
fn cell(a: f64, b: f64) -> usize {
    (((a - b).rem_euclid(1.0) * 64.0) as usize).min(63)
}

/// Rows 32 and 0 of smallpt differ by exactly 1/2 at every draw. With the program's samplers, the differences of two
/// rows are uniform.
pub(super) fn differences(trials: &mut Trials) {
    let draws = 1000;
    let (mut zero, mut other) = (smallpt_row(0), smallpt_row(32));
    let halves = (0..draws).filter(|_| (erand48(&mut zero) - erand48(&mut other)).abs() == 0.5).count();
    trials.same("smallpt, rows 0 and 32: draws that differ by 1/2", &draws, &halves);
    let pairs = [(0, 32), (0, 1), (1, 2), (64, 128), (100, 101), (0, 767)];
    let limit = critical(keyed().count() * pairs.len());
    for (name, sampler) in keyed() {
        for (a, b) in pairs {
            let mut cells = [0; 64];
            for draw in 0..trials.times(20_000, 60_000) as u16 {
                let pair = |y: u32| {
                    let key = SampleKey { seed: 1, pixel: y * 1024, sample: 0 };
                    sampler.pair(Address { key, bounce: draw, branch: 0, purpose: Purpose::Bsdf })
                };
                let (a, b) = (pair(a), pair(b));
                (0..2).for_each(|axis| cells[cell(a[axis], b[axis])] += 1);
            }
            trials.deviates_below(format!("{name}, rows {a} and {b}"), limit, even(&cells));
        }
    }
}

/// The first draws of neighbours differ by 1664525/2^32 = 0.000387552427 with a generator seeded by the pixel.
pub(super) fn neighbours(trials: &mut Trials) {
    let step = lcg_of_pixel(1001) - lcg_of_pixel(1000);
    trials.close("seeded by the pixel: difference of neighbours", 0.000_387_552_427, step, 1e-12);
    let constant: Vec<f64> = (0..PIXELS).map(|pixel| lcg_of_pixel(pixel) - 0.5).collect();
    trials.at_least("seeded by the pixel: correlation, in deviations", 800.0, correlation(&constant, &constant[1..]));
    let limit = critical(2 * keyed().count());
    for (name, sampler) in keyed() {
        let noise: Vec<f64> =
            (0..PIXELS).map(|pixel| first(&*sampler, 1, pixel, 0, (0, Purpose::Film))[0] - 0.5).collect();
        trials.deviates_below(format!("{name}: correlation"), limit, correlation(&noise, &noise[1..]));
        let mut cells = [0; 64];
        // Disjoint pairs, so that no number counts twice.
        noise.chunks_exact(2).for_each(|two| cells[cell(two[1], two[0])] += 1);
        trials.deviates_below(format!("{name}: differences, chi-square"), limit, even(&cells));
    }
}
