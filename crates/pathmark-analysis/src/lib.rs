//! Statistics: plain numbers in, estimates with intervals out.
//!
//! Nothing here depends on records, draws a figure or reads a clock. Input without an answer (too few values, a value
//! that is not finite, a spread of zero as divisor) gives `None`, never NaN.

pub mod aa_test;
pub mod adjacent_pairs;
pub mod autocorrelation;
pub mod balance;
mod bisection;
pub mod bootstrap;
pub mod chi_square;
pub mod confidence_sequence;
pub mod crossed;
pub mod equivalence;
pub mod error_ratio;
pub mod fit;
pub mod interval;
pub mod jackknife;
pub mod mean;
pub mod measured_price;
pub mod metg;
pub mod mse;
pub mod parallel_overhead;
pub mod price;
pub mod quantile;
pub mod randomness;
pub mod rank;
pub mod rank_sum;
pub mod ranking;
pub mod scaling_law;
pub mod slope;
pub mod speedup;
pub mod tail;
mod trimmed;
pub mod z_test;

pub use interval::{Estimate, Interval};
