//! Chi-square tests of counts, as scores that are standard normal for correct counts. A score is above 0 if the counts
//! scatter too much, and below 0 if they are too even, which is also a fault.

use super::z_test::normal_quantile;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Returns the score of a chi-square value with `freedom` degrees of freedom; infinite if there are none.
pub fn score(statistic: f64, freedom: f64) -> f64 {
    let Ok(law) = ChiSquared::new(freedom) else { return f64::INFINITY };
    // From the smaller tail: the other rounds to 1.
    let (below, above) = (law.cdf(statistic), law.sf(statistic));
    if above < below {
        normal_quantile(above).map_or(f64::INFINITY, |z| -z)
    } else {
        normal_quantile(below).unwrap_or(f64::NEG_INFINITY)
    }
}

/// Returns the score of counts that should be equal.
pub fn even(counts: &[u32]) -> f64 {
    let mean = counts.iter().map(|count| f64::from(*count)).sum::<f64>() / counts.len() as f64;
    let squares: f64 = counts.iter().map(|count| (f64::from(*count) - mean) * (f64::from(*count) - mean)).sum();
    score(squares / mean, counts.len() as f64 - 1.0)
}

/// Returns the score of counts against expected ones with the same sum. Cells that expect fewer than 5 are pooled. A
/// pool that still expects fewer is judged alone: the score is infinite if more than 25 were observed, which has a
/// probability below 1e-10.
pub fn against(observed: &[f64], expected: &[f64]) -> f64 {
    let (mut statistic, mut cells, mut pool) = (0.0, 0, (0.0, 0.0));
    for (&seen, &right) in observed.iter().zip(expected) {
        if right < 5.0 {
            pool = (pool.0 + seen, pool.1 + right);
        } else {
            statistic += (seen - right) * (seen - right) / right;
            cells += 1;
        }
    }
    if pool.1 >= 5.0 {
        statistic += (pool.0 - pool.1) * (pool.0 - pool.1) / pool.1;
        cells += 1;
    } else if pool.0 > 25.0 {
        return f64::INFINITY;
    }
    if cells < 2 { 0.0 } else { score(statistic, f64::from(cells - 1)) }
}
