//! Independence of the random numbers of different uses: every pair of the first 64.

use super::{LEVEL, Use, all_keyed, first_uses};
use pathmark::analysis::randomness::correlation;
use pathmark::analysis::z_test::{critical_value, sidak};
use pathmark::sampling::{REFERENCE_SEEDS, Sampler};

const NUMBERS: usize = 64;
const PAIRS: usize = NUMBERS * (NUMBERS - 1) / 2;

/// The first 64 numbers of a sample, minus 1/2.
fn numbers(sampler: &dyn Sampler, uses: &[Use], seed: u64, pixel: u32, sample: u32) -> Vec<f64> {
    uses.iter().flat_map(|used| sampler.pair(used.of(seed, pixel, sample))).map(|u| u - 0.5).collect()
}

/// Within a pixel, two uses are uncorrelated: over the pixels their correlation has mean 0 and a variance near that of
/// independent samples. Uses that visit one sequence in the same order have 64 times this variance, though each sample
/// alone is fine.
#[test]
fn uses_do_not_go_together_within_a_pixel() {
    const SAMPLES: u32 = 64;
    const PIXELS: u32 = 256;
    let uses = first_uses();
    let samplers = all_keyed();
    let limit = critical_value(sidak(LEVEL, samplers.len() * PAIRS).unwrap()).unwrap();
    for (name, sampler) in samplers {
        let mut scores = vec![Vec::new(); PAIRS];
        for pixel in 0..PIXELS {
            let samples: Vec<Vec<f64>> = (0..SAMPLES).map(|k| numbers(&*sampler, &uses, 2, pixel, k)).collect();
            let column = |index: usize| samples.iter().map(|sample| sample[index]).collect();
            let all: Vec<Vec<f64>> = (0..NUMBERS).map(column).collect();
            let mut score = scores.iter_mut();
            for index in 0..NUMBERS {
                for (other, score) in (0..index).zip(score.by_ref()) {
                    score.push(correlation(&all[index], &all[other]));
                }
            }
        }
        let mut total = 0.0;
        for (pair, scores) in scores.iter().enumerate() {
            let n = scores.len() as f64;
            let squares = scores.iter().map(|z| z * z).sum::<f64>() / n;
            let mean = scores.iter().sum::<f64>() / (n * squares).sqrt();
            assert!(mean.abs() < limit, "{name} pair {pair}: {mean} standard deviations from none");
            assert!(squares < 12.0, "{name} pair {pair}: {squares} times the variance of independent samples");
            total += squares / PAIRS as f64;
        }
        assert!(total < 2.0, "{name}: on average {total} times the variance of independent samples");
    }
}

/// A pixel's noise is independent of the noise of its neighbour, of the pixel below and of other seeds, including
/// references: samples 0 and 5.
#[test]
fn pixels_and_seeds_share_no_noise() {
    const WIDTH: u32 = 256;
    const PIXELS: u32 = WIDTH * 32;
    let seeds = [2, 3, 1 << 32, REFERENCE_SEEDS | 2];
    let uses = first_uses();
    let samplers = all_keyed();
    let limit = critical_value(sidak(LEVEL, samplers.len() * 2 * uses.len() * (2 + seeds.len())).unwrap()).unwrap();
    for (name, sampler) in samplers {
        for used in &uses {
            for sample in [0, 5] {
                let noise = |seed: u64, pixels: u32| -> Vec<f64> {
                    (0..pixels).map(|pixel| sampler.pair(used.of(seed, pixel, sample))[0] - 0.5).collect()
                };
                let image = noise(seeds[0], PIXELS + WIDTH);
                let neighbours = [1, WIDTH as usize].map(|first| image[first..first + PIXELS as usize].to_vec());
                let others = neighbours.into_iter().chain(seeds[1..].iter().map(|seed| noise(*seed, PIXELS)));
                for (index, other) in others.enumerate() {
                    let z = correlation(&image[..PIXELS as usize], &other);
                    assert!(z.abs() < limit, "{name} {used:?} sample {sample}, against {index}: {z} deviations");
                }
            }
        }
    }
}
