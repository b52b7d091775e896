//! Statistics of measurements, tried on numbers whose truth is known. Seeds are fixed, and what is a count of chances is two-sided: too few
//! misses are as wrong as too many.

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
