//! Speedup laws: fits to measured speedups, with a check of each fit.
//!
//! * Amdahl: S = 1 / (s + (1 - s) / p) (G. M. Amdahl, "Validity of the single processor approach to achieving large scale computing
//!   capabilities", AFIPS 1967), for one problem on more workers.
//! * Gustafson: S = p - s (p - 1) (J. L. Gustafson, "Reevaluating Amdahl's law", Communications of the ACM 31(5), 1988), for a problem
//!   that grows with the workers.
//! * Universal: S = p / (1 + sigma (p - 1) + kappa p (p - 1)) (N. J. Gunther, "A simple capacity model of massively
//!   parallel transaction systems", CMG 1993; "Guerrilla Capacity Planning", 2007), where sigma is contention and kappa
//!   is the cost of agreement, which grows with the number of pairs of workers. Its peak is at p = sqrt((1 - sigma) /
//!   kappa).
//!
//! Each law is linear in its parameters once S is transformed (see [`Law`]), so least squares needs no search. All laws
//! give S = 1 at p = 1, so points at one worker carry no information about the parameters and are left out. The
//! relative error of a speedup is assumed to be equal at every p. Intervals come from a bootstrap over the repetitions
//! at each p.
//!
//! A fit that can't identify its parameters returns a [`Reason`] instead. One worker count above 1 fixes one parameter
//! and leaves no point to check the law with, which the fit reports. A curve with two parameters passes through any two
//! points, so the universal law needs at least three worker counts above 1.

mod check;
mod estimator;
#[cfg(test)]
mod tests;

use std::fmt;

use super::bootstrap;
use super::interval::Estimate;

pub use check::{Check, SIGNIFICANCE};

/// Workers p and the speedup of each repetition.
pub type Point = (usize, Vec<f64>);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// p / S - 1 = s (p - 1).
    Amdahl,
    /// p - S = s (p - 1).
    Gustafson,
    /// p / S - 1 = sigma (p - 1) + kappa p (p - 1).
    Universal,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    pub name: &'static str,
    /// Its value, without a unit, and the bootstrap interval.
    pub estimate: Estimate,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    pub law: Law,
    /// s; or sigma and kappa.
    pub parameters: Vec<Parameter>,
    /// Workers at the highest speedup of the universal law; `None` for the other laws, which have no peak, and if kappa
    /// can't be distinguished from 0.
    pub peak: Option<Estimate>,
    /// Whether the residuals are larger than the scatter of the repetitions explains.
    pub check: Check,
    /// Number of worker counts above 1 that the fit used.
    pub worker_counts: usize,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Fit {
    Found(Fitted),
    /// The parameters can't be identified, for this reason.
    Unidentifiable(Reason),
}

impl Law {
    /// Returns the names of its parameters, in order.
    pub fn parameters(self) -> &'static [&'static str] {
        match self {
            Self::Amdahl | Self::Gustafson => &["s"],
            Self::Universal => &["sigma", "kappa"],
        }
    }

    /// Returns the number of worker counts above 1 that a fit needs.
    pub fn least_worker_counts(self) -> usize {
        if self == Self::Universal { 3 } else { 1 }
    }
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Amdahl => "Amdahl's law",
            Self::Gustafson => "Gustafson's law",
            Self::Universal => "the Universal Scalability Law",
        })
    }
}

/// Fits `law` to `points`, in any order; points with the same number of workers are pooled. Gustafson's law expects
/// scaled speedups.
pub fn fit(law: Law, points: &[Point], level: f64) -> Fit {
    try_fit(law, points, level).map_or_else(Fit::Unidentifiable, Fit::Found)
}

fn try_fit(law: Law, points: &[Point], level: f64) -> Result<Fitted, Reason> {
    let (workers, groups) = prepared(points)?;
    if workers.len() < law.least_worker_counts() {
        return Err(Reason::TooFewWorkerCounts { found: workers.len(), needed: law.least_worker_counts() });
    }
    if groups.iter().any(|group| group.len() < 2) {
        return Err(Reason::TooFewRepetitions);
    }
    let solve = |groups: &[Vec<f64>]| estimator::parameters(law, &workers, groups);
    let estimates = bootstrap::of_groups(&groups, level, solve).ok_or(Reason::NoSpread)?;
    let names = law.parameters();
    let parameters: Vec<Parameter> =
        names.iter().zip(estimates).map(|(&name, estimate)| Parameter { name, estimate }).collect();
    for (&parameter, range) in parameters.iter().zip(RANGES) {
        judge(parameter, range)?;
    }
    let values = estimates.map(|estimate| estimate.value);
    Ok(Fitted {
        law,
        peak: if law == Law::Universal { peak(&workers, &groups, level) } else { None },
        check: check::lack_of_fit(law, values, &workers, &groups),
        worker_counts: workers.len(),
        parameters,
    })
}

/// Worker counts above 1 in ascending order, and the speedups at each.
fn prepared(points: &[Point]) -> Result<(Vec<f64>, Vec<Vec<f64>>), Reason> {
    let mut pooled = std::collections::BTreeMap::<usize, Vec<f64>>::new();
    for (workers, speedups) in points {
        if *workers == 0 || speedups.iter().any(|&speedup| !(speedup > 0.0 && speedup.is_finite())) {
            return Err(Reason::NotASpeedup);
        }
        pooled.entry(*workers).or_default().extend(speedups);
    }
    pooled.retain(|&workers, speedups| workers > 1 && !speedups.is_empty());
    Ok(pooled.into_iter().map(|(workers, speedups)| (workers as f64, speedups)).unzip())
}

/// The allowed range of each parameter: the first is a share, the second a cost.
const RANGES: [(f64, f64); 2] = [(0.0, 1.0), (0.0, f64::INFINITY)];

/// Refuses a parameter whose interval covers its whole range, or whose value lies outside the range.
fn judge(parameter: Parameter, (low, high): (f64, f64)) -> Result<(), Reason> {
    let Parameter { estimate: Estimate { value, interval }, .. } = parameter;
    if interval.low <= low && interval.high >= high {
        return Err(Reason::Open { parameter });
    }
    if value < low || value > high {
        return Err(Reason::OutOfRange { parameter, low, high });
    }
    Ok(())
}

/// The number of workers at the peak of the universal law; `None` if a resample has no peak, because its kappa is not
/// positive or its sigma is 1 or more.
fn peak(workers: &[f64], groups: &[Vec<f64>], level: f64) -> Option<Estimate> {
    let of_sample = |groups: &[Vec<f64>]| {
        let [sigma, kappa] = estimator::parameters(Law::Universal, workers, groups)?;
        (kappa > 0.0 && sigma < 1.0).then(|| [((1.0 - sigma) / kappa).sqrt()])
    };
    bootstrap::of_groups(groups, level, of_sample).map(|[estimate]| estimate)
}

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
                write!(f, "{} is open: its interval covers everything that {} can be", parameter, parameter.name)
            }
            Self::OutOfRange { parameter, low, high } => {
                let range = if high.is_finite() { format!("outside {low} to {high}") } else { format!("below {low}") };
                write!(f, "the estimate {parameter} is {range}")?;
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

/// Writes a parameter with its value and interval.
impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, estimate: Estimate { value, interval } } = self;
        let percent = interval.percent();
        write!(f, "{name} = {value:.3} ({percent} % interval {:.3} to {:.3})", interval.low, interval.high)
    }
}
