//! Whether a fitted law describes the points: the residuals against the scatter of the repetitions.
//!
//! The F test for lack of fit (N. R. Draper and H. Smith, "Applied Regression Analysis", 1998, 2.1): the weighted sum of squares around the
//! curve is that of the repetitions around their means, the pure error, with n - m degrees of freedom, and that of the means around the
//! curve, with m - q, for n repetitions at m worker counts and q parameters. If the law holds, the quotient of their mean squares follows
//! F(m - q, n - m).

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::{Law, estimator};
use crate::mean::Moments;

/// The law is rejected if residuals this large are less likely than this while it holds.
pub const SIGNIFICANCE: f64 = 0.05;

/// What the residuals say.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Check {
    /// The residuals are no larger than the scatter of the repetitions explains.
    Passed {
        /// Probability of residuals at least this large if the law holds.
        p_value: f64,
    },
    /// The points lie off the curve: the law does not describe them, whatever its parameters say.
    Rejected {
        /// Probability of residuals at least this large if the law holds.
        p_value: f64,
    },
    /// As many parameters as worker counts: the curve goes through every point, whether or not the law holds.
    NotPossible,
}

impl std::fmt::Display for Check {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let level = 100.0 * SIGNIFICANCE;
        match self {
            Self::Passed { p_value } => {
                write!(f, "not rejected by its residuals (F test at {level:.0} %, p = {p_value:.2})")
            }
            Self::Rejected { p_value } if *p_value < 0.001 => {
                write!(f, "rejected: the residuals are larger than the scatter (F test at {level:.0} %, p < 0.001)")
            }
            Self::Rejected { p_value } => {
                write!(
                    f,
                    "rejected: the residuals are larger than the scatter (F test at {level:.0} %, p = {p_value:.3})"
                )
            }
            Self::NotPossible => f.write_str("unchecked: as many parameters as worker counts"),
        }
    }
}

/// The test for parameters that were fitted to these groups.
pub(super) fn lack_of_fit(law: Law, parameters: [f64; 2], workers: &[f64], groups: &[Vec<f64>]) -> Check {
    let repetitions: usize = groups.iter().map(Vec::len).sum();
    let free_means = workers.len().saturating_sub(law.parameters().len());
    let free_repetitions = repetitions.saturating_sub(workers.len());
    let (mut of_means, mut of_repetitions) = (0.0, 0.0);
    for (&p, group) in workers.iter().zip(groups) {
        let each: Vec<f64> = group.iter().map(|&speedup| estimator::lost(law, p, speedup)).collect();
        let moments = Moments::of(&each);
        let (Some(mean), Some(variance)) = (moments.mean(), moments.population_variance()) else {
            return Check::NotPossible;
        };
        let weight = estimator::weight(law, p, mean) * group.len() as f64;
        let residual = mean - estimator::predicted(law, parameters, p);
        of_means += weight * residual * residual;
        of_repetitions += weight * variance;
    }
    let Ok(distribution) = FisherSnedecor::new(free_means as f64, free_repetitions as f64) else {
        return Check::NotPossible;
    };
    let quotient = (of_means / free_means as f64) / (of_repetitions / free_repetitions as f64);
    let p_value = distribution.sf(quotient);
    if p_value < SIGNIFICANCE { Check::Rejected { p_value } } else { Check::Passed { p_value } }
}
