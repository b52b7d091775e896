//! Means and variances in one pass, and intervals from Student's t.
//!
//! The recurrence is B. P. Welford, "Note on a method for calculating corrected sums of squares and products", Technometrics 4
//! (1962): it keeps its digits where the difference of two sums of squares loses them.

use serde::Serialize;
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
    /// The moments of all `values`.
    pub fn of(values: &[f64]) -> Self {
        let mut moments = Self::default();
        for &value in values {
            moments.push(value);
        }
        moments
    }

    /// Takes one more value in.
    pub fn push(&mut self, value: f64) {
        self.count += 1;
        let from_old = value - self.mean;
        self.mean += from_old / self.count as f64;
        self.deviations += from_old * (value - self.mean);
    }

    /// How many values there were.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The mean; `None` for no values or one that is not finite.
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0 && self.mean.is_finite()).then_some(self.mean)
    }

    /// Sum of squared deviations over n: of values that are all there is.
    pub fn population_variance(&self) -> Option<f64> {
        self.variance_over(self.count)
    }

    /// Sum of squared deviations over n - 1: of values that are a sample. `None` below two.
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

/// On which scale an interval of the RMSE was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RmseMethod {
    /// t-interval of the mean squared error, then the square root of its ends.
    Mse,
    /// Interval of a log-normal mean squared error, for seeds that scatter widely.
    LogMse,
}

/// Root mean squared error over several seeds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rmse {
    /// Square root of the mean of the seeds' MSE, and its interval.
    pub estimate: Estimate,
    /// How the interval was made.
    pub method: RmseMethod,
    /// Standard deviation of the seeds' MSE over their mean.
    pub variation: f64,
}

/// Above this coefficient of variation the t-interval of the MSE covers noticeably less than it says.
pub const LOG_ABOVE_VARIATION: f64 = 0.3;

/// The RMSE from one MSE a seed. `None` below two seeds, for equal MSE, or for one that is not positive and finite.
///
/// The t-interval of the MSE is used while the seeds agree. When their coefficient of variation exceeds
/// [`LOG_ABOVE_VARIATION`], the MSE is taken to be log-normal, and the interval is U. Olsson's modified Cox interval of a log-normal
/// mean, "Confidence intervals for the mean of a log-normal distribution", Journal of Statistics Education 13 (2005):
/// m + s^2/2 +- t sqrt(s^2/n + s^4/(2 (n - 1))), with m and s those of ln MSE.
pub fn rmse_interval(mse: &[f64], level: f64) -> Option<Rmse> {
    if mse.iter().any(|&value| !(value > 0.0 && value.is_finite())) {
        return None;
    }
    let plain = t_interval(mse, level)?;
    let variation = Moments::of(mse).sample_variance()?.sqrt() / plain.value;
    let (method, of_mse) = if variation > LOG_ABOVE_VARIATION {
        (RmseMethod::LogMse, log_normal_mean(mse, level)?)
    } else {
        (RmseMethod::Mse, plain.interval)
    };
    // A few seeds that just agree to 30 % can have a lower end below zero, where an MSE can't be.
    let interval = Interval::between(of_mse.low.max(0.0).sqrt(), of_mse.high.sqrt(), level)?;
    Some(Rmse { estimate: Estimate { value: plain.value.sqrt(), interval }, method, variation })
}

/// The modified Cox interval of the mean of positive, log-normal values.
fn log_normal_mean(values: &[f64], level: f64) -> Option<Interval> {
    let logs: Vec<f64> = values.iter().map(|&value| libm::log(value)).collect();
    let moments = Moments::of(&logs);
    let (n, variance) = (logs.len() as f64, moments.sample_variance()?);
    let centre = moments.mean()? + 0.5 * variance;
    let standard_error = (variance / n + variance * variance / (2.0 * (n - 1.0))).sqrt();
    let half_width = t_quantile(level, logs.len() - 1)? * standard_error;
    Interval::between(libm::exp(centre - half_width), libm::exp(centre + half_width), level)
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
    fn welford_keeps_digits_beside_a_large_offset() {
        // Four values of variance 22.5 (n) and 30 (n - 1) on 1e8, where the difference of sums of squares has no digit left.
        let moments = Moments::of(&[4.0, 7.0, 13.0, 16.0].map(|value| value + 1e8));
        assert_eq!(moments.mean(), Some(1e8 + 10.0));
        assert_eq!(moments.population_variance(), Some(22.5));
        assert_eq!(moments.sample_variance(), Some(30.0));
        assert_eq!(moments.count(), 4);
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
    fn t_interval_covers_what_it_says() {
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
    fn rmse_of_agreeing_seeds_is_the_root_of_the_t_interval() {
        let mse = [0.9, 1.0, 1.1, 1.05, 0.95];
        let rmse = rmse_interval(&mse, 0.95).unwrap();
        let plain = t_interval(&mse, 0.95).unwrap();
        assert_eq!(rmse.method, RmseMethod::Mse);
        assert!((rmse.estimate.value - plain.value.sqrt()).abs() < 1e-12);
        assert!((rmse.estimate.interval.high - plain.interval.high.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn rmse_of_scattered_seeds_covers_better_on_the_log_scale() {
        // Log-normal MSE with coefficient of variation 1 (sigma^2 = ln 2), five seeds: the plain t-interval covers 85.8 %.
        let sigma = std::f64::consts::LN_2.sqrt();
        let truth = std::f64::consts::SQRT_2.sqrt();
        let mut generator = Pcg64Dxsm::new(3, 7);
        let (mut hits, mut plain_hits) = (0, 0);
        for _ in 0..4000 {
            let mse: Vec<f64> = (0..5).map(|_| libm::exp(sigma * normal(&mut generator))).collect();
            hits += usize::from(rmse_interval(&mse, 0.95).unwrap().estimate.interval.contains(truth));
            plain_hits += usize::from(t_interval(&mse, 0.95).unwrap().interval.contains(truth * truth));
        }
        let (share, plain_share) = (f64::from(hits as u32) / 4000.0, f64::from(plain_hits as u32) / 4000.0);
        assert!((plain_share - 0.858).abs() < 0.015, "{plain_share}");
        assert!((0.93..0.985).contains(&share), "{share}");
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
        assert_eq!(rmse_interval(&[1.0, 0.0], 0.95), None);
        assert_eq!(rmse_interval(&[1.0, 1.0], 0.95), None);
        assert_eq!(rmse_interval(&[f64::NAN, 1.0], 0.95), None);
    }
}
