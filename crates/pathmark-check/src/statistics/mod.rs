//! Statistics of measurements, tested on data with known truth. Seeds are fixed. Counts of random events are tested on
//! both sides: too few misses are as wrong as too many.

mod draw;
mod intervals;
mod references;
mod seeds;
mod speed;
mod tails;

use super::{Section, case};

pub(super) const SECTION: Section = Section {
    title: "Statistics of measurements",
    cases: &[
        case("M01", "the error against an independent reference", references::independent),
        case("M02", "how many samples a reference needs", references::enough),
        case("M03", "the cross form of two half-references", references::cross),
        case("M08", "errors of linear values and of what a display shows", references::linear),
        case("M04", "samples that an image shares with its reference", seeds::shared_samples),
        case("M05", "a reference by the image's own estimator", seeds::shared_bias),
        case("M06", "intervals of the RMSE over seeds", intervals::over_few_seeds),
        case("M09", "many comparisons at once, of equal work", intervals::many_comparisons),
        case("M10", "the median's interval from order statistics", intervals::of_the_median),
        case("M07", "kurtosis and the largest sample's share", tails::heavy_tails),
        case("M11", "the price of an accuracy, and paying it", speed::price),
        case("M12", "speedups above the number of workers and below 1", speed::odd_speedups),
    ],
};
