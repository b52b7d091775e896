//! Endless paths, Russian roulette, depth limits and clamps, and the way from samples to sums, pieces and images.

mod cuts;
mod display;
mod invalid_samples;
mod long_paths;
mod order;
mod pieces;
mod platform;
mod roulette;
mod sums;
pub(crate) mod unguarded;

use super::Section;

pub(super) const SECTION: Section = Section {
    title: "Paths, sums and images",
    cases: &[
        long_paths::CASES,
        roulette::CASES,
        cuts::CASES,
        invalid_samples::CASES,
        sums::CASES,
        order::CASES,
        pieces::CASES,
        display::CASES,
        platform::CASES,
    ],
};
