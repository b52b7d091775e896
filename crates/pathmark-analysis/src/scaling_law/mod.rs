//! Laws of speedup fitted to measured speedups, and whether they may be believed.
//!
//! * Amdahl: S = 1 / (s + (1 - s) / p) (G. M. Amdahl, "Validity of the single processor approach to achieving large scale computing
//!   capabilities", AFIPS 1967), for one problem on more workers.
//! * Gustafson: S = p - s (p - 1) (J. L. Gustafson, "Reevaluating Amdahl's law", Communications of the ACM 31(5), 1988), for a problem
//!   that grows with the workers.
//! * Universal: S = p / (1 + sigma (p - 1) + kappa p (p - 1)) (N. J. Gunther, "A simple capacity model of massively parallel transaction
//!   systems", CMG 1993; "Guerrilla Capacity Planning", 2007), where sigma is contention and kappa the cost of agreement, which grows with every
//!   pair of workers. Its peak is at p = sqrt((1 - sigma) / kappa).
//!
//! Each is linear in its parameters once S is turned round (see [`Law`]), so least squares needs no search. All laws pass through S = 1 at
//! p = 1 by their form, so points at one worker say nothing about parameters and are left out. Errors are taken to be a share of the speedup,
//! of one size at every p. Intervals come from a bootstrap over the repetitions at each p.
//!
//! What can't be identified gives a [`Reason`] instead of numbers. One worker count above 1 fixes one parameter and leaves nothing
//! to check the law by, which the fit says. A curve with two parameters goes through any two points, whatever law they obey, so the
//! universal law is fitted from three worker counts above 1 on.

mod check;
mod estimator;
mod reason;
#[cfg(test)]
mod tests;

use serde::Serialize;

use super::bootstrap;
use super::interval::Estimate;

pub use check::{Check, SIGNIFICANCE};
pub use reason::Reason;

/// Workers p and the speedup of each repetition.
pub type Point = (usize, Vec<f64>);

/// A law of speedup.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// p / S - 1 = s (p - 1).
    Amdahl,
    /// p - S = s (p - 1).
    Gustafson,
    /// p / S - 1 = sigma (p - 1) + kappa p (p - 1).
    Universal,
}

/// A parameter of a law.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Parameter {
    /// What it is called.
    pub name: &'static str,
    /// Its value, without a unit, and the bootstrap interval.
    pub estimate: Estimate,
}

/// A law that describes the points, as far as could be checked.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fitted {
    /// The law.
    pub law: Law,
    /// s; or sigma and kappa.
    pub parameters: Vec<Parameter>,
    /// Workers at the highest speedup of the universal law; `None` for the other laws, which have no peak, and for a kappa that can't be
    /// told from 0.
    pub peak: Option<Estimate>,
    /// Whether the points lie off the curve by more than their repetitions scatter.
    pub check: Check,
    /// Worker counts above 1 that went into it.
    pub worker_counts: usize,
}

/// The outcome of a fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fit {
    /// A law with its parameters.
    Found(Fitted),
    /// Numbers would mean nothing, and why.
    Unidentifiable(Reason),
}

impl Law {
    /// What its parameters are called, in order.
    pub fn parameters(self) -> &'static [&'static str] {
        match self {
            Self::Amdahl | Self::Gustafson => &["s"],
            Self::Universal => &["sigma", "kappa"],
        }
    }

    /// How many worker counts above 1 a fit needs.
    pub fn least_worker_counts(self) -> usize {
        if self == Self::Universal { 3 } else { 1 }
    }
}

impl std::fmt::Display for Law {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Amdahl => "Amdahl's law",
            Self::Gustafson => "Gustafson's law",
            Self::Universal => "the Universal Scalability Law",
        })
    }
}

/// Fits `law` to `points`, in any order; points with the same number of workers are pooled. Gustafson's law wants scaled speedups.
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

/// The smallest and the largest value that each parameter can have: the first is a share, the second a cost.
const RANGES: [(f64, f64); 2] = [(0.0, 1.0), (0.0, f64::INFINITY)];

/// Refuses a parameter that the data leave open and one that the law does not allow.
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

/// The workers at the peak of the universal law. A resample without one, because its kappa is not positive, leaves none.
fn peak(workers: &[f64], groups: &[Vec<f64>], level: f64) -> Option<Estimate> {
    let of_sample = |groups: &[Vec<f64>]| {
        let [sigma, kappa] = estimator::parameters(Law::Universal, workers, groups)?;
        (kappa > 0.0 && sigma < 1.0).then(|| [((1.0 - sigma) / kappa).sqrt()])
    };
    bootstrap::of_groups(groups, level, of_sample).map(|[estimate]| estimate)
}
