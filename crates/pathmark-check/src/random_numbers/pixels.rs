//! Random numbers across the pixels of an image: R04; and those of neighbouring pixels together, through a battery of
//! tests for generators: R14.

use super::unguarded::{draw, sequential_state, sequential_stream};
use super::{first, keyed, worst};
use crate::analysis::chi_square::{even, score};
use crate::analysis::randomness::battery::{birthdays, bytes, pairs, ranks, single_bits};
use crate::analysis::randomness::correlation;
use crate::sampling::{Purpose, is_spread};
use crate::{Trials, critical};
use rand_pcg::Pcg32;

const WIDTH: usize = 1024;
const PIXELS: usize = WIDTH * 768;
const SEEDS: [u64; 4] = [1, 2, 0x0123_4567_89AB_CDEF, 1 << 63];
const USES: [(u16, Purpose); 4] = [(0, Purpose::Film), (1, Purpose::Bsdf), (3, Purpose::Bsdf), (6, Purpose::Roulette)];
/// The neighbours to the right, below and on both diagonals, and pixels two and a power of two away.
const LAGS: [usize; 8] = [1, 2, 64, WIDTH - 1, WIDTH, WIDTH + 1, 2 * WIDTH, 256 * WIDTH];

/// Random numbers minus 1/2, by draw.
type Draws = Vec<Vec<f64>>;

fn chi_square(numbers: &[f64]) -> f64 {
    let mut cells = [0; 256];
    for u in numbers {
        cells[((u + 0.5) * 256.0) as usize] += 1;
    }
    even(&cells)
}

/// Scores of the cells of each draw, of the lags of each draw, and of each pair of draws of a pixel.
fn scores(draws: &Draws) -> [Vec<f64>; 3] {
    let cells = draws.iter().map(|numbers| chi_square(numbers)).collect();
    let lags = draws.iter().flat_map(|numbers| LAGS.map(|lag| correlation(numbers, &numbers[lag..]))).collect();
    let pairs = (0..draws.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
    [cells, lags, pairs.map(|(a, b)| correlation(&draws[a], &draws[b])).collect()]
}

pub(super) fn across(trials: &mut Trials) {
    let samples = trials.times(1, 16) as u32;
    let tests = keyed().count() * SEEDS.len() * samples as usize * (USES.len() * 2 * (1 + LAGS.len()) + 28);
    let limit = critical(tests);
    let whole = critical(3 * keyed().count());
    for (name, sampler) in keyed() {
        let mut all = [const { Vec::new() }; 3];
        // Samplers that spread a pixel's samples are slower, and their first samples are as independent as any.
        let seeds = if is_spread(name) { trials.times(1, 4) } else { trials.times(2, 4) };
        for seed in SEEDS.into_iter().take(seeds as usize) {
            for sample in 0..samples {
                let mut draws: Draws = vec![Vec::with_capacity(PIXELS); 2 * USES.len()];
                for pixel in 0..PIXELS as u32 {
                    for (index, used) in USES.into_iter().enumerate() {
                        let numbers = first(&*sampler, seed, pixel, sample, used);
                        (0..2).for_each(|axis| draws[2 * index + axis].push(numbers[axis] - 0.5));
                    }
                }
                for (all, scores) in all.iter_mut().zip(scores(&draws)) {
                    all.extend(scores);
                }
            }
        }
        for (what, scores) in ["256 cells", "lags", "pairs of draws"].iter().zip(&all) {
            trials.deviates_below(format!("{name}, {what}: worst of {}", scores.len()), limit, worst(scores));
            // Together the scores must scatter exactly as much as chance predicts.
            let squares = scores.iter().map(|z| z * z).sum();
            trials.deviates_below(format!("{name}, {what}: squares"), whole, score(squares, scores.len() as f64));
        }
    }
    sequential(trials);
}

/// Programs that use the pixel index as state or stream of PCG32 fill cells too evenly or too unevenly by 3.8 to 9.2
/// deviations, and correlate neighbours by 23.6 and 11.9 deviations.
fn sequential(trials: &mut Trials) {
    let generators = [
        ("PCG32, state = pixel", sequential_state as fn(u32) -> Pcg32, 20.0),
        ("PCG32, stream = pixel", sequential_stream, 10.0),
    ];
    for (name, generator, least) in generators {
        let mut draws: Draws = vec![vec![0.0; PIXELS]; 8];
        for pixel in 0..PIXELS {
            let mut pcg = generator(pixel as u32);
            for numbers in &mut draws {
                numbers[pixel] = draw(&mut pcg) - 0.5;
            }
        }
        let [cells, lags, _] = scores(&draws);
        trials.at_least(format!("{name}, 256 cells: worst deviation"), 5.0, worst(&cells).abs());
        trials.at_least(format!("{name}, lags: worst deviation"), least, worst(&lags).abs());
    }
}

/// The draws of a pixel.
const BATTERY_USES: [(u16, Purpose); 4] =
    [(1, Purpose::Bsdf), (2, Purpose::Bsdf), (3, Purpose::Light), (6, Purpose::Roulette)];
const DRAWS: u32 = 2 * BATTERY_USES.len() as u32;

/// The leading 53 bits of a number.
fn bits(u: f64) -> u64 {
    (u * 9_007_199_254_740_992.0) as u64
}

pub(super) fn battery(trials: &mut Trials) {
    let pixels = trials.times(1 << 16, 1 << 21) as u32;
    let limit = critical(keyed().count() * 2 * (5 + 53));
    for (name, sampler) in keyed() {
        let pixel_major: Vec<u64> = (0..pixels)
            .flat_map(|pixel| BATTERY_USES.into_iter().flat_map(move |used| [(pixel, used)]))
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
