//! Every deterministic sampler of the table, tested for the properties that estimators need besides the hard cases
//! (`crates/pathmark-check/src/random_numbers`): nets, strata, convergence rates, and the joint distribution of uses.
//!
//! Every group of tests has a family-wise level of 1e-3 (Sidak), two-sided: numbers that are too even are as wrong as
//! numbers that are too uneven. Seeds are fixed, so a pass is reproducible.

mod nets;
mod projections;
mod rate;

use pathmark::sampling::{Address, Purpose, SAMPLERS, SampleKey, Sampler, keyed_sampler};

const LEVEL: f64 = 1e-3;

/// A sampler and its name.
type Named = (&'static str, Box<dyn Sampler>);

fn keyed(name: &str) -> Box<dyn Sampler> {
    keyed_sampler(name).unwrap()
}

fn all_keyed() -> Vec<Named> {
    let keyed_ones = SAMPLERS.iter().filter(|entry| entry.deterministic);
    keyed_ones.map(|entry| (entry.name, keyed(entry.name))).collect()
}

/// A use of random numbers along a path.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Use {
    bounce: u16,
    branch: u16,
    purpose: Purpose,
}

const PURPOSES: [Purpose; 4] = [Purpose::Film, Purpose::Bsdf, Purpose::Roulette, Purpose::Medium];

/// The uses of 64 random numbers: four purposes at eight bounces.
fn first_uses() -> Vec<Use> {
    (0..8).flat_map(|bounce| PURPOSES.map(|purpose| Use { bounce, branch: 0, purpose })).collect()
}

impl Use {
    fn of(self, seed: u64, pixel: u32, sample: u32) -> Address {
        let key = SampleKey { seed, pixel, sample };
        Address { key, bounce: self.bounce, branch: self.branch, purpose: self.purpose }
    }
}
