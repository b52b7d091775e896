//! Means and variances in one pass, and intervals from Student's t.
//!
//! The recurrence is B. P. Welford, "Note on a method for calculating corrected sums of squares and products",
//! Technometrics 4 (1962). It keeps the precision that the difference of two sums of squares loses.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::interval::{Estimate, Interval, is_level};

/// Count, mean and sum of squared deviations of a stream of values.
#[derive(Debug, Clone, Copy, Default)]
pub struct Moments {
    count: u64,
    mean: f64,
    deviations: f64,
}

impl Moments {
    pub fn of(values: &[f64]) -> Self {
        let mut moments = Self::default();
        for &value in values {
            moments.push(value);
        }
        moments
    }

    pub fn push(&mut self, value: f64) {
        self.count += 1;
        let from_old = value - self.mean;
        self.mean += from_old / self.count as f64;
        self.deviations += from_old * (value - self.mean);
    }

    pub fn count(&self) -> u64 {
        self.count
    }

    /// The mean; `None` for no values or one that is not finite.
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0 && self.mean.is_finite()).then_some(self.mean)
    }

    /// Returns the sum of squared deviations over n, for values that are the whole population.
    pub fn population_variance(&self) -> Option<f64> {
        self.variance_over(self.count)
    }

    /// Returns the sum of squared deviations over n - 1, for values that are a sample. `None` below two values.
    pub fn sample_variance(&self) -> Option<f64> {
        self.variance_over(self.count.saturating_sub(1))
    }

    /// The standard error of the mean; `None` below two values.
    pub fn standard_error(&self) -> Option<f64> {
        Some((self.sample_variance()? / self.count as f64).sqrt())
    }

    fn variance_over(&self, divisor: u64) -> Option<f64> {
        (divisor > 0 && self.deviations.is_finite()).then(|| self.deviations / divisor as f64)
    }
}

/// The half width, in standard errors, of a two-sided interval with this `level`: 2.776 for 95 % and 4 degrees of freedom.
pub fn t_quantile(level: f64, degrees_of_freedom: usize) -> Option<f64> {
    if !is_level(level) || degrees_of_freedom == 0 {
        return None;
    }
    let distribution = StudentsT::new(0.0, 1.0, degrees_of_freedom as f64).ok()?;
    Some(distribution.inverse_cdf(0.5 + 0.5 * level)).filter(|t| t.is_finite())
}

/// The mean with its t-interval; `None` below two values, without spread, or with a value that is not finite.
pub fn t_interval(values: &[f64], level: f64) -> Option<Estimate> {
    let moments = Moments::of(values);
    let standard_error = moments.standard_error().filter(|&error| error > 0.0)?;
    let value = moments.mean()?;
    let half_width = t_quantile(level, values.len() - 1)? * standard_error;
    Some(Estimate { value, interval: Interval::around(value, half_width, level)? })
}

/// Returns the geometric mean of positive values with the t-interval of their logarithms, which never reaches below 0:
/// for times that other programs disturb. `None` below two values, without spread, or with a value that is not positive
/// and finite.
pub fn geometric_interval(values: &[f64], level: f64) -> Option<Estimate> {
    if values.iter().any(|&value| value <= 0.0) {
        return None;
    }
    let logarithms: Vec<f64> = values.iter().map(|&value| libm::log(value)).collect();
    let Estimate { value, interval } = t_interval(&logarithms, level)?;
    let interval = Interval::between(libm::exp(interval.low), libm::exp(interval.high), level)?;
    Some(Estimate { value: libm::exp(value), interval })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use rand_pcg::Pcg64Dxsm;

    /// A standard normal deviate by G. E. P. Box and M. E. Muller (1958).
    fn normal(generator: &mut Pcg64Dxsm) -> f64 {
        let mut uniform = || ((generator.next_u64() >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0;
        (-2.0 * libm::log(uniform())).sqrt() * libm::cos(std::f64::consts::TAU * uniform())
    }

    #[test]
    fn t_quantiles_of_the_printed_table() {
        for (df, expected) in [(1, 12.7062), (2, 4.30265), (4, 2.77645), (9, 2.26216), (30, 2.04227), (1000, 1.96234)] {
            let t = t_quantile(0.95, df).unwrap();
            assert!((t - expected).abs() < 6e-5, "{df}: {t}");
        }
    }

    #[test]
    fn t_interval_of_a_small_sample() {
        // Mean 3, s^2 = 2.5, standard error sqrt(0.5), t = 2.77645: 3 +- 1.96324.
        let estimate = t_interval(&[1.0, 2.0, 3.0, 4.0, 5.0], 0.95).unwrap();
        assert!((estimate.value - 3.0).abs() < 1e-12);
        assert!((estimate.interval.low - 1.036_757).abs() < 1e-5 && (estimate.interval.high - 4.963_243).abs() < 1e-5);
    }

    #[test]
    fn one_disturbed_time_leaves_the_interval_above_zero() {
        // Logarithms 0, 0, 0 and 3 ln 2: mean 0.75 ln 2, standard error 0.75 ln 2, t with three degrees of freedom 3.18245.
        let estimate = geometric_interval(&[1.0, 1.0, 1.0, 8.0], 0.95).unwrap();
        assert!((estimate.value - libm::exp2(0.75)).abs() < 1e-12);
        assert!((estimate.interval.low - libm::exp2(0.75 * (1.0 - 3.182_446))).abs() < 1e-5);
        assert!(t_interval(&[1.0, 1.0, 1.0, 8.0], 0.95).unwrap().interval.low < 0.0);
        assert_eq!(geometric_interval(&[1.0, 0.0], 0.95), None);
    }

    #[test]
    fn t_interval_covers_at_its_level() {
        // 4000 samples of five normal values; the simulation's standard deviation is 0.34 %.
        let mut generator = Pcg64Dxsm::new(11, 5);
        let hits = (0..4000)
            .filter(|_| {
                let values: Vec<f64> = (0..5).map(|_| normal(&mut generator)).collect();
                t_interval(&values, 0.95).unwrap().interval.contains(0.0)
            })
            .count();
        assert!((hits as f64 / 4000.0 - 0.95).abs() < 0.0115, "{hits}");
    }

    #[test]
    fn degenerate_input_has_no_answer() {
        assert_eq!(Moments::default().mean(), None);
        assert_eq!(Moments::of(&[1.0]).sample_variance(), None);
        assert_eq!(Moments::of(&[1.0]).population_variance(), Some(0.0));
        assert_eq!(Moments::of(&[1.0, f64::NAN]).mean(), None);
        assert_eq!(Moments::of(&[1.0, f64::INFINITY]).sample_variance(), None);
        assert_eq!(t_interval(&[], 0.95), None);
        assert_eq!(t_interval(&[1.0], 0.95), None);
        assert_eq!(t_interval(&[1.0, 1.0], 0.95), None);
        assert_eq!(t_interval(&[1.0, f64::NAN], 0.95), None);
        assert_eq!(t_interval(&[1.0, 2.0], 1.0), None);
        assert_eq!(t_quantile(0.95, 0), None);
    }
}
