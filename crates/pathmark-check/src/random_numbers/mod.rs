//! Cases about random numbers.

mod extremes;
mod keys;
mod ledger;
mod pixels;
mod rows;
mod seeds;
mod spread;
mod threads;
pub(crate) mod unguarded;

use super::{Section, case};
use crate::sampling::{Address, Purpose, SAMPLERS, SampleKey, Sampler, keyed_sampler};
use std::borrow::Borrow;

pub(super) const SECTION: Section = Section {
    title: "Random numbers",
    cases: &[
        case("R01", "rows of an image share no stream, as smallpt's rows do", rows::rows),
        case("R02", "rows do not differ by a constant at every draw, as smallpt's do", rows::differences),
        case("R03", "neighbours differ by no constant, as they would with the pixel as the seed", rows::neighbours),
        case("R04", "8 draws of 786 432 pixels, up to 4 seeds: chi-square, two-sided, and lags", pixels::across),
        case("R05", "no key of pixels and seeds makes a generator of zeros", keys::zeros),
        case("R06", "no two addresses share their numbers; the mix is a bijection", keys::collisions),
        case("R07", "noise of seeds s and s + 2^k at all lags, draws and images", seeds::seeds),
        case("R12", "generators that threads share: flagged, fair and never the same for two threads", threads::shared),
        case("R09", "0 and 1 - 2^-53 through every camera, material, light and estimator", extremes::consumers),
        case("R11", "free paths in fog for 0, 1 - 2^-53 and all between", extremes::free_paths),
        case("R10", "the topmost and the lowest 2^20 integers as numbers: never 1", extremes::below_one),
        case("R13", "within a sample no number is used twice, in every scene by every estimator", ledger::once),
        case("R14", "streams of pixels, interleaved: bytes, pairs, bits, birthdays and ranks", pixels::battery),
        case("R15", "means over scramblings after any number of samples, and every two numbers", spread::spread),
    ],
};

/// The samplers whose random numbers depend on the address alone, each with its name.
fn keyed() -> impl Iterator<Item = (&'static str, Box<dyn Sampler>)> {
    SAMPLERS.iter().filter_map(|entry| keyed_sampler(entry.name).map(|sampler| (entry.name, sampler)))
}

/// The score with the largest absolute value.
fn worst(scores: impl IntoIterator<Item: Borrow<f64>>) -> f64 {
    let scores = scores.into_iter().map(|z| *z.borrow());
    scores.fold(0.0, |worst: f64, z| if z.abs() > worst.abs() { z } else { worst })
}

/// The pair of one use of random numbers on the main path.
fn first(sampler: &dyn Sampler, seed: u64, pixel: u32, sample: u32, (bounce, purpose): (u16, Purpose)) -> [f64; 2] {
    sampler.pair(Address { key: SampleKey { seed, pixel, sample }, bounce, branch: 0, purpose })
}
