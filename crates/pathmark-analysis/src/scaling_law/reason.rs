//! Reasons why a speedup law can't be fitted, with messages for the reader of the report.

use std::fmt;

use super::Parameter;

/// The reason why a fit gives no parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reason {
    /// A speedup that is not positive and finite, or no worker at all.
    NotASpeedup,
    /// Too few different numbers of workers above 1.
    TooFewWorkerCounts { found: usize, needed: usize },
    /// Fewer than two repetitions at some number of workers.
    TooFewRepetitions,
    /// All repetitions are equal, so they don't show their scatter.
    NoSpread,
    /// The interval of a parameter covers all values that the law allows.
    Open { parameter: Parameter },
    /// The estimate of a parameter lies outside the range that the law allows, which may end in infinity.
    OutOfRange { parameter: Parameter, low: f64, high: f64 },
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotASpeedup => f.write_str("there is a speedup that is not positive and finite"),
            Self::TooFewWorkerCounts { found, needed } => {
                let (be, plural) = if found == 1 { ("is", "") } else { ("are", "s") };
                write!(f, "there {be} {found} worker count{plural} above 1, and the law needs at least {needed}")
            }
            Self::TooFewRepetitions => f.write_str("a worker count has fewer than two repetitions"),
            Self::NoSpread => {
                f.write_str("all repetitions are equal, so that nothing tells how far they can be trusted")
            }
            Self::Open { parameter } => {
                write!(f, "{} is open: its interval covers everything that {} can be", Shown(parameter), parameter.name)
            }
            Self::OutOfRange { parameter, low, high } => {
                let range = if high.is_finite() { format!("outside {low} to {high}") } else { format!("below {low}") };
                write!(f, "the estimate {} is {range}", Shown(parameter))?;
                let interval = parameter.estimate.interval;
                let edge = parameter.estimate.value.clamp(low, high);
                if interval.contains(edge) {
                    write!(f, ", and the data can't tell it from {edge}")
                } else if parameter.estimate.value < low {
                    f.write_str(": the speedups are higher than the law allows")
                } else {
                    f.write_str(": the speedups are lower than the law allows")
                }
            }
        }
    }
}

/// A parameter with its value and interval.
struct Shown(Parameter);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Parameter { name, estimate } = self.0;
        let (value, interval) = (estimate.value, estimate.interval);
        let percent = 100.0 * interval.level;
        write!(f, "{name} = {value:.3} ({percent:.0} % interval {:.3} to {:.3})", interval.low, interval.high)
    }
}
