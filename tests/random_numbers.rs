//! The sampler `independent`, judged across pixels, samples and seeds: R04, R06, R07 of the catalogue of hard cases.
//!
//! Every group of tests has a family-wise level of 1e-3 (Sidak), two-sided: numbers that are too uniform are as wrong as numbers that are
//! not uniform enough. Seeds are fixed, so a pass is reproducible.

use pathmark::analysis::z_test::{critical_value, sidak};
use pathmark::measure::LARGEST_SEED;
use pathmark::sampling::{Address, Independent, Purpose, REFERENCE_SEEDS, SampleKey, Sampler};
use statrs::distribution::{ChiSquared, ContinuousCDF};

const LEVEL: f64 = 1e-3;
const WIDTH: usize = 1024;
const PIXELS: usize = WIDTH * 768;

fn pair(seed: u64, pixel: u32, sample: u32, bounce: u16, purpose: Purpose) -> [f64; 2] {
    Independent.pair(Address { key: SampleKey { seed, pixel, sample }, bounce, branch: 0, purpose })
}

/// The uses of numbers at the start of a path and where roulette sets in.
const USES: [(u16, Purpose); 6] = [
    (0, Purpose::Film),
    (1, Purpose::Bsdf),
    (2, Purpose::Bsdf),
    (3, Purpose::Bsdf),
    (6, Purpose::Bsdf),
    (6, Purpose::Roulette),
];
const SEEDS: [u64; 2] = [1, 0x0123_4567_89AB_CDEF];

/// The two draws of one use for all pixels, centred on 0.
fn draws(seed: u64, sample: u32, (bounce, purpose): (u16, Purpose)) -> [Vec<f64>; 2] {
    let pairs = (0..PIXELS as u32).map(|pixel| pair(seed, pixel, sample, bounce, purpose));
    pairs.map(|[u, v]| (u - 0.5, v - 0.5)).unzip().into()
}

/// sqrt(n) times the correlation of two sequences of uniform numbers: standard normal if they are independent.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    12.0 * sum / (a.len().min(b.len()) as f64).sqrt()
}

/// R04: 256 cells, 786 432 pixels, each draw of each use, two seeds.
#[test]
fn every_draw_is_uniform_over_the_pixels() {
    let tail = sidak(LEVEL, SEEDS.len() * USES.len() * 2).unwrap() / 2.0;
    let distribution = ChiSquared::new(255.0).unwrap();
    let (low, high) = (distribution.inverse_cdf(tail), distribution.inverse_cdf(1.0 - tail));
    for seed in SEEDS {
        for used in USES {
            for (index, numbers) in draws(seed, 0, used).iter().enumerate() {
                let mut cells = [0.0; 256];
                for u in numbers {
                    cells[((u + 0.5) * 256.0) as usize] += 1.0;
                }
                let mean = PIXELS as f64 / 256.0;
                let chi2: f64 = cells.iter().map(|n| (n - mean) * (n - mean) / mean).sum();
                assert!((low..high).contains(&chi2), "seed {seed} {used:?} draw {index}: {chi2} not in {low}..{high}");
            }
        }
    }
}

/// R04: neighbours to the right (lag 1) and below (lag W), and the next sample of the same pixel, are uncorrelated.
#[test]
fn neighbours_are_uncorrelated() {
    let limit = critical_value(sidak(LEVEL, SEEDS.len() * USES.len() * 2 * 3).unwrap()).unwrap();
    for seed in SEEDS {
        for used in USES {
            for (numbers, next) in draws(seed, 0, used).iter().zip(&draws(seed, 1, used)) {
                let (right, below) = (correlation(&numbers[1..], numbers), correlation(&numbers[WIDTH..], numbers));
                for (what, z) in [("lag 1", right), ("lag W", below), ("next sample", correlation(numbers, next))] {
                    assert!(z.abs() < limit, "seed {seed} {used:?} {what}: {z} standard deviations");
                }
            }
        }
    }
}

/// R04 along the path: the numbers of different uses of the same sample, and the two of a pair, are uncorrelated. Generators that share
/// a state and differ in the stream alone fail here by up to a hundred standard deviations, and bias roulette.
#[test]
fn the_numbers_of_a_path_are_uncorrelated() {
    let mut scores = Vec::new();
    for seed in SEEDS {
        let columns: Vec<_> =
            USES.iter().flat_map(|used| draws(seed, 0, *used).map(|numbers| (*used, numbers))).collect();
        for (index, (used, numbers)) in columns.iter().enumerate() {
            for (other, others) in &columns[..index] {
                scores.push((correlation(numbers, others), seed, *used, *other));
            }
        }
    }
    check_scores(&scores);
}

/// No score beyond its limit, and together as scattered as independent standard normal values: neither more nor less.
fn check_scores<T: std::fmt::Debug>(scores: &[(f64, u64, T, T)]) {
    let limit = critical_value(sidak(LEVEL, scores.len()).unwrap()).unwrap();
    let beyond: Vec<_> = scores.iter().filter(|score| score.0.abs() >= limit).collect();
    assert!(beyond.is_empty(), "{} of {} beyond {limit} standard deviations: {beyond:?}", beyond.len(), scores.len());
    let squares: f64 = scores.iter().map(|score| score.0 * score.0).sum();
    let distribution = ChiSquared::new(scores.len() as f64).unwrap();
    let (low, high) = (distribution.inverse_cdf(LEVEL / 2.0), distribution.inverse_cdf(1.0 - LEVEL / 2.0));
    assert!((low..high).contains(&squares), "{} squared scores add up to {squares}", scores.len());
}

/// The 106 bits of the first draw.
fn bits(seed: u64, pixel: u32, sample: u32) -> u128 {
    let [u, v] = pair(seed, pixel, sample, 0, Purpose::Film);
    u128::from(u.to_bits()) << 64 | u128::from(v.to_bits())
}

/// R06: 2^20 (pixel, sample) of one seed, no first draw twice: by chance one in 1e20 such sets has a pair. Nor does a seed of references
/// share one with a seed of images, not even where they differ in the top bit alone.
#[test]
fn no_two_addresses_share_their_numbers() {
    assert_eq!(LARGEST_SEED + 1, REFERENCE_SEEDS, "every seed is an image's or a reference's");
    for (seed, reference) in [(1, REFERENCE_SEEDS | 1), (0, REFERENCE_SEEDS), (LARGEST_SEED, u64::MAX)] {
        let places = (0..1u32 << 20).map(|k| (k / 16, k % 16));
        let mut all: Vec<u128> = places.clone().map(|(pixel, sample)| bits(seed, pixel, sample)).collect();
        all.extend(places.map(|(pixel, sample)| bits(reference, pixel, sample)));
        all.sort_unstable();
        assert!(
            all.windows(2).all(|two| two[0] != two[1]),
            "seeds {seed} and {reference} share a draw, or one repeats"
        );
    }
}

/// R07: the same pixel and sample under different seeds; references against images among them.
#[test]
fn seeds_share_no_noise() {
    let seeds = [1, 2, 3, 4, 1 << 32, REFERENCE_SEEDS, REFERENCE_SEEDS | 1, REFERENCE_SEEDS | 2];
    let all: Vec<_> = seeds.iter().map(|seed| draws(*seed, 0, (0, Purpose::Film))).collect();
    let mut scores = Vec::new();
    for (index, one) in all.iter().enumerate() {
        for (other, another) in all[..index].iter().enumerate() {
            for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                scores.push((correlation(&one[a], &another[b]), seeds[index], seeds[index], seeds[other]));
            }
        }
    }
    check_scores(&scores);
}

/// R07: the noise of image s is not that of s + 1 or s + 2^k, shifted: all lags in a window of 33 x 33, and their sum of squares, whose
/// mean is their number and whose variance is twice that.
#[test]
fn seeds_make_unrelated_images() {
    const SIDE: usize = 192;
    const REACH: isize = 16;
    let noise = |seed: u64| -> Vec<f64> {
        (0..(SIDE * SIDE) as u32).map(|pixel| pair(seed, pixel, 0, 0, Purpose::Film)[0] - 0.5).collect()
    };
    let others = [1, 2, 1 << 8, 1 << 16, 1 << 31, 1 << 32, 1 << 48, 1 << 63];
    let lags = (2 * REACH + 1) * (2 * REACH + 1);
    let limit = critical_value(sidak(LEVEL, others.len() * lags as usize).unwrap()).unwrap();
    let limit_of_sum = critical_value(sidak(LEVEL, others.len()).unwrap()).unwrap();
    let image = noise(5);
    for other in others {
        let shifted = noise(5 + other);
        let mut sum = 0.0;
        for dy in -REACH..=REACH {
            for dx in -REACH..=REACH {
                // On a torus every lag has all the pixels.
                let wrap = |k: usize, d: isize| (k as isize + d).rem_euclid(SIDE as isize) as usize;
                let mut product = 0.0;
                for y in 0..SIDE {
                    let (row, start) = (&image[y * SIDE..(y + 1) * SIDE], wrap(y, dy) * SIDE);
                    let turned = &shifted[start..start + SIDE];
                    let (head, tail) = turned.split_at(wrap(0, dx));
                    product += row.iter().zip(tail.iter().chain(head)).map(|(a, b)| a * b).sum::<f64>();
                }
                let z = 12.0 * product / SIDE as f64;
                assert!(z.abs() < limit, "seeds 5 and 5 + {other}, lag {dx},{dy}: {z} standard deviations");
                sum += z * z;
            }
        }
        let z = (sum - lags as f64) / (2.0 * lags as f64).sqrt();
        assert!(z.abs() < limit_of_sum, "seeds 5 and 5 + {other}: squares of all lags add up to {sum} for {lags}");
    }
}
