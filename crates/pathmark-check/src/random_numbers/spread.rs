//! Samplers that spread a pixel's samples: R15, run for every keyed sampler.

use super::{first, keyed, worst};
use crate::analysis::chi_square::even;
use crate::sampling::{Purpose, Sampler};
use crate::{Trials, critical};

/// Random numbers for the position in the pixel and for the first two directions.
const USES: [(u16, Purpose); 3] = [(0, Purpose::Film), (1, Purpose::Bsdf), (2, Purpose::Bsdf)];

/// A function of a sample's subpixel and random numbers, with its mean.
struct Integrand {
    name: &'static str,
    value: fn(u32, [[f64; 2]; 3]) -> f64,
    mean: f64,
}

/// Smooth integrands, an edge, one of all six numbers, and integrands that differ by subpixel.
const INTEGRANDS: [Integrand; 6] = [
    Integrand { name: "product", value: |_, [[u, v], ..]| u * v, mean: 0.25 },
    Integrand { name: "edge", value: |_, [[u, v], ..]| f64::from(u8::from(u + v < 0.7)), mean: 0.245 },
    Integrand { name: "two uses", value: |_, [[u, _], [v, _], _]| u * v, mean: 0.25 },
    Integrand {
        name: "six numbers",
        value: |_, numbers| numbers.iter().flatten().map(|u| 2.0 * u).product(),
        mean: 1.0,
    },
    Integrand {
        name: "first subpixel",
        value: |subpixel, [[u, v], [s, _], _]| if subpixel == 0 { 4.0 * u * u * v + s } else { 0.0 },
        mean: (4.0 / 6.0 + 0.5) / 4.0,
    },
    Integrand {
        name: "edge across subpixels",
        value: |subpixel, [_, [u, v], _]| f64::from(u8::from(u + v < 0.4 * f64::from(subpixel))),
        mean: (0.08 + 0.32 + (1.0 - 0.8 * 0.8 / 2.0)) / 4.0,
    },
];

/// Errors of all integrands after each of these numbers of samples, which ascend.
fn errors(sampler: &dyn Sampler, seed: u64, pixel: u32, counts: &[u32]) -> Vec<[f64; INTEGRANDS.len()]> {
    let (mut sums, mut drawn) = ([0.0; INTEGRANDS.len()], 0);
    let after = |count: &u32| {
        while drawn < *count {
            let numbers = USES.map(|used| first(sampler, seed, pixel, drawn, used));
            for (sum, integrand) in sums.iter_mut().zip(&INTEGRANDS) {
                *sum += (integrand.value)(drawn % 4, numbers);
            }
            drawn += 1;
        }
        std::array::from_fn(|index| sums[index] / f64::from(*count) - INTEGRANDS[index].mean)
    };
    counts.iter().map(after).collect()
}

pub(super) fn spread(trials: &mut Trials) {
    means(trials);
    convergence(trials);
    projections(trials);
}

/// The mean over scramblings is right: for complete and incomplete sets of strata, for square and other counts, and
/// for even and odd seeds.
fn means(trials: &mut Trials) {
    const COUNTS: [u32; 6] = [4, 12, 16, 20, 64, 100];
    let scramblings = trials.times(1000, 10_000) as u32;
    let limit = critical(keyed().count() * COUNTS.len() * INTEGRANDS.len());
    for (name, sampler) in keyed() {
        // Sum and sum of squares, by number of samples and integrand.
        let mut sums = [[[0.0; 2]; INTEGRANDS.len()]; COUNTS.len()];
        for pixel in 0..scramblings {
            let errors = errors(&*sampler, u64::from(3 + pixel % 2), pixel, &COUNTS);
            for ([sum, squares], error) in sums.iter_mut().flatten().zip(errors.iter().flatten()) {
                *sum += error;
                *squares += error * error;
            }
        }
        for (samples, sums) in COUNTS.iter().zip(&sums) {
            for (integrand, [sum, squares]) in INTEGRANDS.iter().zip(sums) {
                let what = format!("{name}, {}, {samples} samples", integrand.name);
                trials.deviates_below(what, limit, sum / squares.sqrt());
            }
        }
    }
}

/// One scrambling, many samples: each pixel converges to the mean, also if the function differs by subpixel. Sobol's
/// original order would leave an error of the size of the integrand for ever.
fn convergence(trials: &mut Trials) {
    let samples = trials.times(1 << 13, 1 << 18) as u32;
    // Six standard deviations of independent samples of the integrand with the largest variance, 4.6.
    let allowed = 6.0 * (4.6 / f64::from(samples)).sqrt();
    for (name, sampler) in keyed() {
        let pixels = [0, 1, 2, 3].map(|pixel| errors(&*sampler, 3, pixel, &[samples])[0]);
        for (index, integrand) in INTEGRANDS.iter().enumerate() {
            let worst = pixels.iter().map(|errors| errors[index].abs()).fold(0.0, f64::max);
            trials.at_most(format!("{name}, {}: worst pixel after {samples} samples", integrand.name), allowed, worst);
        }
    }
}

const PURPOSES: [Purpose; 4] = [Purpose::Film, Purpose::Bsdf, Purpose::Roulette, Purpose::Medium];

/// Chi-square on 4 x 4 cells of every pair of the first 32 numbers. Each pixel gives one sample, so that counts are
/// multinomial.
fn projections(trials: &mut Trials) {
    let pixels = trials.times(1 << 13, 1 << 18) as u32;
    let uses: Vec<_> = (0..4).flat_map(|bounce| PURPOSES.map(|purpose| (bounce, purpose))).collect();
    let numbers = 2 * uses.len();
    let pairs = numbers * (numbers - 1) / 2;
    let samples = [0, 1, 6, 70_001];
    let limit = critical(keyed().count() * samples.len() * pairs);
    for (name, sampler) in keyed() {
        for sample in samples {
            let mut together = vec![[0; 16]; pairs];
            for pixel in 0..pixels {
                let all = uses.iter().flat_map(|used| first(&*sampler, 1, pixel, sample, *used));
                let cells: Vec<usize> = all.map(|u| (u * 4.0) as usize).collect();
                let mut pair = together.iter_mut();
                for (index, cell) in cells.iter().enumerate() {
                    for (other, counts) in cells[..index].iter().zip(pair.by_ref()) {
                        counts[4 * cell + other] += 1;
                    }
                }
            }
            let scores = together.iter().map(|counts| even(counts));
            trials.deviates_below(
                format!("{name}, sample {sample}: worst of {pairs} pairs of numbers"),
                limit,
                worst(scores),
            );
        }
    }
}
