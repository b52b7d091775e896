//! Means and variances in one pass, and intervals from Student's t.
//!
//! The recurrence is B. P. Welford, "Note on a method for calculating corrected sums of squares and products",
//! Technometrics 4 (1962). It keeps the precision that the difference of two sums of squares loses.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::bisection::smallest;
use super::equivalence::Measured;
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
    fractional_t_quantile(level, degrees_of_freedom as f64)
}

/// [`t_quantile`] for degrees of freedom that are no whole number.
pub(crate) fn fractional_t_quantile(level: f64, degrees_of_freedom: f64) -> Option<f64> {
    let law = StudentsT::new(0.0, 1.0, degrees_of_freedom).ok().filter(|_| is_level(level))?;
    Some(law.inverse_cdf(0.5 + 0.5 * level)).filter(|t| t.is_finite())
}

/// The mean with its t-interval; `None` below two values, without spread, or with a value that is not finite.
pub fn t_interval(values: &[f64], level: f64) -> Option<Estimate> {
    Measured::of_mean(values).filter(Measured::has_spread)?.estimate(level)
}

/// Returns the geometric mean of positive values with the t-interval of their logarithms, which never reaches below 0:
/// for times that other programs disturb. `None` below two values, without spread, or with a value that is not positive
/// and finite.
pub fn geometric_interval(values: &[f64], level: f64) -> Option<Estimate> {
    if values.iter().any(|&value| value <= 0.0) {
        return None;
    }
    let logarithms: Vec<f64> = values.iter().map(|&value| libm::log(value)).collect();
    t_interval(&logarithms, level)?.exp()
}

/// The ratio of the means of two independent samples, with Student's interval of its logarithm and the degrees of freedom of B. L.
/// Welch, "The generalization of 'Student's' problem when several different population variances are involved", Biometrika 34
/// (1947). `None` below two values on a side, without spread, or for a mean that is not positive.
///
/// The whole interval of level 1 - 2 a lies within a margin exactly if both one-sided tests of level a reject a ratio beyond it (D.
/// J. Schuirmann, "A comparison of the two one-sided tests procedure ...", 1987): then the means are equivalent.
pub fn mean_ratio(above: &[f64], below: &[f64], level: f64) -> Option<Estimate> {
    // With its relative error, which is that of its logarithm.
    let side = |values: &[f64]| {
        let mean = Measured::of_mean(values).filter(|mean| mean.value > 0.0)?;
        Some(Measured { standard_error: mean.standard_error / mean.value, ..mean })
    };
    let (above, below) = (side(above)?, side(below)?);
    let (value, factor) = (above.value / below.value, libm::exp(above.minus(below).half_width(level)?));
    Some(Estimate { value, interval: Interval::between(value / factor, value * factor, level)? })
}

/// The fewest values of this standard deviation for which Student's interval of their mean reaches at most so far to either side;
/// `None` if a million do not suffice.
pub fn fewest_values(deviation: f64, half_width: f64, level: f64) -> Option<usize> {
    let is_enough =
        |n: usize| t_quantile(level, n - 1).is_some_and(|t| t * deviation / (n as f64).sqrt() <= half_width);
    // The half width falls with the number of values.
    (deviation >= 0.0 && half_width > 0.0).then(|| smallest(1, 1 << 20, is_enough)).flatten()
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

    /// Relative standard errors: of 1, 2, 3 it is 1 / sqrt(12), of 3, 4, 5, 4 it is 1 / sqrt(96). Welch's degrees of freedom are 2.50515,
    /// for which Simpson's rule on the density gives t = 3.5694.
    #[test]
    fn ratios_of_means_have_the_degrees_of_freedom_of_welch() {
        let found = mean_ratio(&[1.0, 2.0, 3.0], &[3.0, 4.0, 5.0, 4.0], 0.95).unwrap();
        let variance: f64 = 1.0 / 12.0 + 1.0 / 96.0;
        assert!((found.value - 0.5).abs() < 1e-15);
        let half_width = libm::log(found.interval.high / found.value);
        assert!((half_width / variance.sqrt() - 3.5694).abs() < 1e-3, "{}", half_width / variance.sqrt());
        assert!((found.interval.low * found.interval.high - 0.25).abs() < 1e-12);
        // Equal spreads on both sides have all degrees of freedom: 2 + 2.
        let equal = mean_ratio(&[9.0, 10.0, 11.0], &[18.0, 20.0, 22.0], 0.95).unwrap();
        let expected = 2.776_445 * (2.0_f64 * 0.01 / 3.0).sqrt();
        assert!((libm::log(equal.interval.high / 0.5) - expected).abs() < 1e-6);
        for wrong in [[1.0].as_slice(), &[1.0, -1.0], &[2.0, f64::NAN]] {
            assert_eq!((mean_ratio(wrong, &[1.0, 2.0], 0.95), mean_ratio(&[1.0, 2.0], wrong, 0.95)), (None, None));
        }
        assert_eq!(mean_ratio(&[1.0, 1.0], &[1.0, 1.0], 0.95), None);
    }

    /// Two samples of one law with unequal numbers and spreads: the simulation's standard deviation is 0.34 %.
    #[test]
    fn ratios_of_means_cover_at_their_level() {
        let mut generator = Pcg64Dxsm::new(17, 5);
        let hits = (0..4000).filter(|_| {
            let mut sample = |count: usize, spread: f64| -> Vec<f64> {
                (0..count).map(|_| 1.0 + spread * normal(&mut generator)).collect()
            };
            let (above, below) = (sample(3, 0.002), sample(6, 0.01));
            mean_ratio(&above, &below, 0.95).unwrap().interval.contains(1.0)
        });
        let hits = hits.count();
        assert!((hits as f64 / 4000.0 - 0.95).abs() < 0.0115, "{hits}");
    }

    /// t = 2.2622 with nine degrees of freedom: ten values of deviation 1 reach 0.71536, nine do not.
    #[test]
    fn as_many_values_as_a_half_width_needs() {
        assert_eq!(fewest_values(1.0, 0.7154, 0.95), Some(10));
        assert_eq!(fewest_values(1.0, 0.7153, 0.95), Some(11));
        assert_eq!(fewest_values(1.0, 100.0, 0.95), Some(2));
        assert_eq!((fewest_values(1.0, 1e-9, 0.95), fewest_values(1.0, 0.0, 0.95)), (None, None));
        assert_eq!((fewest_values(f64::NAN, 1.0, 0.95), fewest_values(1.0, 1.0, 1.0)), (None, None));
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
