//! Statistics of measurements, tested on data with known truth. Seeds are fixed. Counts of random events are tested on
//! both sides: too few misses are as wrong as too many.

mod draw;
mod intervals;
mod references;
mod seeds;
mod speed;
mod tails;

use super::Section;

pub(super) const SECTION: Section = Section {
    title: "Statistics of measurements",
    cases: &[references::CASES, seeds::CASES, intervals::CASES, tails::CASES, speed::CASES],
};
