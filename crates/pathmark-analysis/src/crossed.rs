//! The interval of a value that depends on two independent samples, such as a forecast on traces and on calibrations.
//!
//! Each value of the first sample is combined with each of the second. In the two-way model without interaction, the
//! error of the grand mean has two parts: the variance of the row means over the number of rows, and the same for
//! columns. F. E. Satterthwaite, "An approximate distribution of estimates of variance components", Biometrics Bulletin
//! 2 (1946), gives the degrees of freedom of their sum. A bootstrap of three values would be too narrow instead.

use super::interval::{Estimate, Interval};
use super::mean::{Moments, t_quantile};

/// A geometric mean, and its interval if one of the samples has a spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossed {
    pub value: f64,
    pub interval: Option<Interval>,
}

/// Returns the geometric mean of all values and its t-interval. `values[i][j]` combines value i of the first sample
/// with value j of the second. A sample of one value adds nothing to the interval. `None` without values, for rows of
/// different lengths, or with a value that is not positive and finite.
pub fn geometric_mean(values: &[Vec<f64>], level: f64) -> Option<Crossed> {
    let columns = values.first()?.len();
    let is_usable = |row: &Vec<f64>| row.len() == columns && row.iter().all(|value| *value > 0.0 && value.is_finite());
    if columns == 0 || !values.iter().all(is_usable) {
        return None;
    }
    let logarithms = |row: &Vec<f64>| row.iter().map(|value| libm::log(*value)).collect();
    let logarithms: Vec<Vec<f64>> = values.iter().map(logarithms).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let of_rows: Vec<f64> = logarithms.iter().map(|row| mean(row)).collect();
    let of_columns: Vec<f64> =
        (0..columns).map(|j| logarithms.iter().map(|row| row[j]).sum::<f64>() / values.len() as f64).collect();
    let centre = mean(&of_rows);
    let interval = around(centre, &[&of_rows, &of_columns], level);
    Some(Crossed { value: libm::exp(centre), interval })
}

/// The interval around a mean of logarithms from the means of each sample's values.
fn around(centre: f64, samples: &[&[f64]], level: f64) -> Option<Interval> {
    let parts = samples.iter().filter_map(|means| {
        let error = Moments::of(means).standard_error()?;
        Some((error * error, means.len() as f64 - 1.0))
    });
    let parts: Vec<(f64, f64)> = parts.collect();
    let variance: f64 = parts.iter().map(|(variance, _)| variance).sum();
    if variance <= 0.0 {
        return None;
    }
    let degrees = variance * variance / parts.iter().map(|(part, degrees)| part * part / degrees).sum::<f64>();
    // Rounded down, which widens the interval; the small number keeps a whole number whole.
    let half = t_quantile(level, (degrees + 1e-9).floor() as usize)? * variance.sqrt();
    Interval::between(libm::exp(centre - half), libm::exp(centre + half), level)
}

impl Crossed {
    /// The value and its interval under a function that rises or falls everywhere; `None` if a result is not finite.
    pub fn through(&self, function: impl Fn(f64) -> Option<f64>) -> Option<Self> {
        let ends = |interval: Interval| {
            let (a, b) = (function(interval.low)?, function(interval.high)?);
            Interval::between(a.min(b), a.max(b), interval.level)
        };
        let interval = match self.interval {
            Some(interval) => Some(ends(interval)?),
            None => None,
        };
        Some(Self { value: function(self.value).filter(|value| value.is_finite())?, interval })
    }

    pub fn estimate(&self) -> Option<Estimate> {
        Some(Estimate { value: self.value, interval: self.interval? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mean::geometric_interval;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-9 * b.abs()
    }

    /// With one value in a sample, the other sample's ordinary interval remains.
    #[test]
    fn one_sample_alone_has_students_interval() {
        let values = [1.0, 2.0, 5.0];
        let expected = geometric_interval(&values, 0.95).unwrap();
        let row = geometric_mean(&[values.to_vec()], 0.95).unwrap();
        let column = geometric_mean(&values.map(|value| vec![value]), 0.95).unwrap();
        for found in [row, column] {
            let interval = found.interval.unwrap();
            assert!(close(found.value, expected.value), "{found:?}");
            assert!(close(interval.low, expected.interval.low) && close(interval.high, expected.interval.high));
        }
    }

    /// Both samples have the logarithms -s, 0 and s: each error is s over the root of 3, and Satterthwaite's degrees of
    /// freedom are 2 + 2. The printed 97.5 % quantile of Student's t with 4 degrees is 2.77645.
    #[test]
    fn errors_of_two_samples_add_up_in_squares() {
        let s: f64 = 0.1;
        let steps = [-s, 0.0, s];
        let values: Vec<Vec<f64>> =
            steps.iter().map(|a| steps.iter().map(|b| 7.0 * libm::exp(a + b)).collect()).collect();
        let found = geometric_mean(&values, 0.95).unwrap();
        let half = libm::log(found.interval.unwrap().high / found.value);
        assert!(close(found.value, 7.0));
        assert!((half - 2.776_45 * s * (2.0_f64 / 3.0).sqrt()).abs() < 1e-5, "{half}");
    }

    #[test]
    fn values_without_spread_have_no_interval() {
        let found = geometric_mean(&[vec![2.0, 2.0], vec![2.0, 2.0]], 0.95).unwrap();
        assert!(close(found.value, 2.0) && found.interval.is_none());
        assert!(found.estimate().is_none());
        for wrong in [vec![], vec![vec![]], vec![vec![1.0], vec![1.0, 2.0]], vec![vec![0.0]], vec![vec![f64::NAN]]] {
            assert_eq!(geometric_mean(&wrong, 0.95), None);
        }
    }

    #[test]
    fn a_falling_function_swaps_the_ends() {
        let found = geometric_mean(&[vec![1.0, 4.0, 2.0]], 0.95).unwrap();
        let inverse = found.through(|value| Some(1.0 / value)).unwrap();
        let (before, after) = (found.interval.unwrap(), inverse.interval.unwrap());
        assert!(
            close(inverse.value, 0.5) && close(after.low, 1.0 / before.high) && close(after.high, 1.0 / before.low)
        );
        assert_eq!(found.through(|_| None), None);
    }
}
