//! Cases about random numbers.

mod conversion;
mod extremes;
mod keys;
mod ledger;
mod pixels;
mod quality;
mod rows;
mod seeds;
mod spread;
mod threads;
pub(crate) mod unguarded;

use super::Section;
use crate::sampling::{Address, Purpose, SampleKey, Sampler};

pub(super) const SECTION: Section = Section {
    title: "Random numbers",
    cases: &[
        rows::CASES,
        pixels::CASES,
        keys::CASES,
        seeds::CASES,
        threads::CASES,
        extremes::CASES,
        conversion::CASES,
        ledger::CASES,
        quality::CASES,
        spread::CASES,
    ],
};

/// The pair of one use of random numbers on the main path.
fn first(sampler: &dyn Sampler, seed: u64, pixel: u32, sample: u32, (bounce, purpose): (u16, Purpose)) -> [f64; 2] {
    sampler.pair(Address { key: SampleKey { seed, pixel, sample }, bounce, branch: 0, purpose })
}
