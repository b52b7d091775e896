//! Lack of fit: whether a fitted law describes the points, by its residuals and the scatter of the repetitions.
//!
//! The F test for lack of fit (N. R. Draper and H. Smith, "Applied Regression Analysis", 1998, 2.1) splits the weighted
//! sum of squares around the curve in two. For n repetitions at m worker counts and q parameters, the repetitions
//! around their means, the pure error, have n - m degrees of freedom, and the means around the curve have m - q. If the
//! law holds, the mean square of the means over the mean square of the repetitions follows F(m - q, n - m).

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::{Law, estimator};
use crate::mean::Moments;

/// The law is rejected if its p-value is below this significance.
pub const SIGNIFICANCE: f64 = 0.05;

/// The outcome of the test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Check {
    /// The scatter of the repetitions explains the residuals. `p_value` is the probability of residuals at least this
    /// large if the law holds.
    Passed { p_value: f64 },
    /// The residuals are larger than the scatter explains: the law does not describe the points, whatever its
    /// parameters are.
    Rejected { p_value: f64 },
    /// The law has as many parameters as there are worker counts, so the curve passes through every point.
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

/// Tests a law with parameters that were fitted to these groups.
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
