//! Autocorrelation of measurements that were made one after the other: how much less they say than independent ones.
//!
//! A machine that is slow now is slow in the next repetition, too. The mean of n values with autocorrelation ρ^k at
//! distance k has the variance τ/n of one value, with τ = 1 + 2 Σ (1 - k/n) ρ^k: the n values say as much as n/τ
//! independent ones (M. S. Bartlett, "Some aspects of the time-correlation problem in regard to tests of significance",
//! Journal of the Royal Statistical Society 98, 1935). The spread of the values around their own mean also shrinks, by
//! (n - τ)/(n - 1).

use super::interval::is_level;
use statrs::distribution::{ContinuousCDF, Normal};

/// Returns the correlation of neighbours in several series, each around its own mean; 0 without any spread.
fn of_neighbours(series: &[&[f64]]) -> f64 {
    let (mut products, mut squares) = (0.0, 0.0);
    for values in series {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        products += values.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum::<f64>();
        squares += values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>();
    }
    if squares > 0.0 { products / squares } else { 0.0 }
}

/// Returns the value that the autocorrelation of two series exceeds with probability `miss` at most, from 0 to 1.
///
/// The correlation of neighbours in n values is too small by (1 + 3ρ)/n on average (F. H. C. Marriott and J. A. Pope,
/// "Bias in the estimation of autocorrelations", Biometrika 41, 1954). The bound comes from R. A. Fisher's
/// transformation of what remains.
fn upper_bound(series: [&[f64]; 2], miss: f64) -> Option<f64> {
    let [m, n] = series.map(|values| values.len() as f64);
    let length = 2.0 * m * n / (m + n);
    if !is_level(miss) || series.iter().any(|values| values.len() <= 3) {
        return None;
    }
    let beyond = Normal::new(0.0, 1.0).ok()?.inverse_cdf(1.0 - miss);
    // Beyond these limits the transformation ends in infinity.
    let correlation = ((of_neighbours(&series) + 1.0 / length) / (1.0 - 3.0 / length)).clamp(-0.99, 0.99);
    Some(libm::tanh(libm::atanh(correlation) + beyond / (m + n - 3.0).sqrt()).max(0.0))
}

/// Returns the variance of the mean of `count` values with this autocorrelation, over what the spread of independent
/// values would say.
fn inflation(count: usize, correlation: f64) -> f64 {
    let n = count as f64;
    let (mut power, mut tau) = (1.0, 1.0);
    for distance in 1..count {
        power *= correlation;
        tau += 2.0 * (1.0 - distance as f64 / n) * power;
    }
    tau * (n - 1.0) / (n - tau)
}

/// Returns the factor by which an interval for independent values must be wider, so that it holds for two series with
/// autocorrelation. It is too small with probability `miss` at most. `None` for series that are too short to tell.
///
/// ```
/// use pathmark_analysis::autocorrelation::widening;
/// let (turns, waves) = ([1.0, 2.0, 1.0, 2.0, 1.0, 2.0, 1.0, 2.0], [1.0, 1.1, 1.3, 1.4, 1.4, 1.3, 1.1, 1.0]);
/// assert_eq!(widening([&turns, &turns], 0.025), Some(1.0));
/// assert!(widening([&waves, &waves], 0.025).unwrap() > 3.0);
/// ```
pub fn widening(series: [&[f64]; 2], miss: f64) -> Option<f64> {
    let correlation = upper_bound(series, miss)?;
    let most = series.map(|values| inflation(values.len(), correlation)).into_iter().fold(1.0, f64::max);
    most.is_finite().then(|| most.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_compared_within_their_series() {
        // Deviations -1.5, -.5, .5, 1.5: products .75 - .25 + .75 = 1.25, squares 5.
        let rising = [1.0, 2.0, 3.0, 4.0];
        assert_eq!(of_neighbours(&[&rising]), 0.25);
        // The step from one series to the next is no pair of neighbours.
        assert_eq!(of_neighbours(&[&rising, &rising.map(|value| value + 100.0)]), 0.25);
        assert_eq!(of_neighbours(&[&[3.0; 5], &[4.0; 5]]), 0.0);
    }

    /// For n = 3 and ρ = 1/2: τ = 1 + 2 (2/3 · 1/2 + 1/3 · 1/4) = 11/6, so the factor is 11/6 · 2 / (7/6) = 22/7. For
    /// long series it approaches (1 + ρ)/(1 - ρ).
    #[test]
    fn the_variance_of_a_mean_grows_with_the_correlation() {
        assert!((inflation(3, 0.5) - 22.0 / 7.0).abs() < 1e-12);
        assert_eq!(inflation(20, 0.0), 1.0);
        assert!((inflation(100_000, 0.5) - 3.0).abs() < 1e-3);
        assert!(inflation(10, 1.0).is_infinite() || inflation(10, 1.0) > 1e12);
    }

    /// Two series of 53 values with a correlation of 0 after the correction: the bound is tanh(1.96 / √103).
    #[test]
    fn the_bound_is_fishers() {
        let bound = |miss: f64| {
            // 0, 1, 0, -1 and so on: neighbours are uncorrelated, which the correction for bias raises to 1/53.
            let values: Vec<f64> = (0..53).map(|at| [0.0, 1.0, 0.0, -1.0][at % 4]).collect();
            upper_bound([&values, &values], miss).unwrap()
        };
        let corrected = 1.0 / 53.0 / (1.0 - 3.0 / 53.0);
        assert!((bound(0.025) - libm::tanh(libm::atanh(corrected) + 1.959_964 / 103.0_f64.sqrt())).abs() < 1e-3);
        assert!(bound(0.001) > bound(0.1));
    }

    #[test]
    fn degenerate_input_has_no_answer() {
        assert_eq!(widening([&[1.0, 2.0, 3.0], &[1.0, 2.0, 3.0]], 0.05), None);
        assert_eq!(widening([&[1.0; 9], &[2.0; 9]], 1.0), None);
        assert_eq!(widening([&[], &[]], 0.05), None);
        assert!(widening([&[1.0; 9], &[2.0; 9]], 0.05).is_some());
    }
}
