//! Endless paths, Russian roulette, depth limits and clamps, and the way from samples to sums, pieces and images.

mod cuts;
mod display;
mod invalid_samples;
mod long_paths;
mod order;
mod pieces;
mod roulette;
mod sums;
pub(crate) mod unguarded;

use super::{Section, case};

pub(super) const SECTION: Section = Section {
    title: "Paths, sums and images",
    cases: &[
        case("P01", "a closed sphere that loses nothing", long_paths::endless),
        case("P02", "ten thousand bounces on a stack of 128 KiB", long_paths::ten_thousand),
        case("P03", "throughputs down to the smallest number", long_paths::underflow),
        case("P04", "random numbers at the chance to survive", roulette::at_the_chance),
        case("P05", "black surfaces end the path: their survival is 0", roulette::black),
        case("P06", "every rule of roulette keeps the mean", roulette::fair),
        case("P07", "the spread that roulette brings", roulette::spread),
        case("P08", "cut after D vertices: Le (1 - rho^D)/(1 - rho), and said", cuts::depth),
        case("P09", "samples clamped to 1: (1 - rho^10)/(1 - rho), and said", cuts::clamp),
        case("P10", "NaN, infinite, negative samples: left out, counted and told", invalid_samples::injected),
        case("P11", "the sum of a million samples and more", sums::long_sums),
        case("P12", "the variance of values far from 0", sums::variance),
        case("P13", "sums of which almost all cancels", sums::cancellation),
        case("P14", "samples and pieces in any order, by every sampler", order::orders),
        case("P15", "every pixel in one piece, whatever is left over", pieces::cover),
        case("P16", "report D's grids", pieces::grids),
        case("P17", "one bright pixel changes no other", display::firefly),
        case("P19", "gamma and rounding at the edges", display::rounding),
        case("P20", "report D's grid of nine with eight threads", pieces::eight_threads),
        case("P18", "the bits of another build and another machine", order::bits),
    ],
};
