//! Every deterministic sampler of the table, judged by what the estimators rely on: R10, R14 and R15 of the catalogue of hard cases.
//!
//! Every group of tests has a family-wise level of 1e-3 (Sidak), two-sided: numbers that are too even are as wrong as numbers that are not
//! even enough. Seeds are fixed, so a pass is reproducible.

mod means;
mod nets;
mod projections;
mod rate;

use pathmark::sampling::{Address, Purpose, SAMPLERS, SampleKey, Sampler, SamplerVisitor, with_keyed_sampler};
use statrs::distribution::{ChiSquared, ContinuousCDF};

const LEVEL: f64 = 1e-3;

/// A sampler and its name.
type Named = (&'static str, Box<dyn Sampler>);

struct Boxed;

impl SamplerVisitor for Boxed {
    type Output = Box<dyn Sampler>;
    fn visit<S: Sampler + 'static>(self, sampler: S) -> Box<dyn Sampler> {
        Box::new(sampler)
    }
}

fn keyed(name: &str) -> Box<dyn Sampler> {
    with_keyed_sampler(name, Boxed).unwrap()
}

fn all_keyed() -> Vec<Named> {
    let keyed_ones = SAMPLERS.iter().filter(|entry| entry.deterministic);
    keyed_ones.map(|entry| (entry.name, keyed(entry.name))).collect()
}

/// A use of numbers along a path.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Use {
    bounce: u16,
    branch: u16,
    purpose: Purpose,
}

const PURPOSES: [Purpose; 4] = [Purpose::Film, Purpose::Bsdf, Purpose::Roulette, Purpose::Medium];

/// 64 numbers: four purposes at eight bounces.
fn first_uses() -> Vec<Use> {
    (0..8).flat_map(|bounce| PURPOSES.map(|purpose| Use { bounce, branch: 0, purpose })).collect()
}

impl Use {
    fn of(self, seed: u64, pixel: u32, sample: u32) -> Address {
        let key = SampleKey { seed, pixel, sample };
        Address { key, bounce: self.bounce, branch: self.branch, purpose: self.purpose }
    }
}

/// Where a chi-square value lies at the level of one of so many tests.
fn chi_square_range(freedom: f64, tests: usize) -> std::ops::Range<f64> {
    let tail = pathmark::analysis::z_test::sidak(LEVEL, tests).unwrap() / 2.0;
    let distribution = ChiSquared::new(freedom).unwrap();
    distribution.inverse_cdf(tail)..distribution.inverse_cdf(1.0 - tail)
}

/// Chi-square of counts that are expected to be equal.
fn chi_square(counts: &[u32]) -> f64 {
    let mean = f64::from(counts.iter().sum::<u32>()) / counts.len() as f64;
    counts.iter().map(|count| (f64::from(*count) - mean) * (f64::from(*count) - mean) / mean).sum()
}
