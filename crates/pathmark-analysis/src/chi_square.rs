//! Counts against what was expected of them, as scores that are standard normal if the counts are right: above 0 if they are scattered too
//! much, below 0 if they are too even, which is wrong too.

use super::z_test::normal_quantile;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// The score of a value of chi-square with so many degrees of freedom; endless if there are none.
pub fn score(statistic: f64, freedom: f64) -> f64 {
    let Ok(law) = ChiSquared::new(freedom) else { return f64::INFINITY };
    // By the nearer tail: the other rounds to 1.
    let (below, above) = (law.cdf(statistic), law.sf(statistic));
    if above < below {
        normal_quantile(above).map_or(f64::INFINITY, |z| -z)
    } else {
        normal_quantile(below).unwrap_or(f64::NEG_INFINITY)
    }
}

/// The score of counts that should be equal.
pub fn even(counts: &[u32]) -> f64 {
    let mean = counts.iter().map(|count| f64::from(*count)).sum::<f64>() / counts.len() as f64;
    let squares: f64 = counts.iter().map(|count| (f64::from(*count) - mean) * (f64::from(*count) - mean)).sum();
    score(squares / mean, counts.len() as f64 - 1.0)
}

/// The score of counts against expected ones with the same sum. Cells that expect fewer than 5 are put together; what is then still fewer
/// is judged as a count by itself: endless where more than 25 have come, which chance has not once in 1e10.
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
