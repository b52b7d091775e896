//! The ratio of two errors: how many times as far do estimates of one kind lie from the known value as those of another?
//!
//! Errors of independent estimates around a known value are normal with mean 0, as means of many samples are. The ratio of
//! their mean squares, over the ratio of the variances, then follows Fisher's F with as many degrees of freedom as there are
//! errors: none is spent on a mean.

use crate::interval::{Estimate, Interval, all_finite, is_level};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// Returns the ratio of the root mean squares of two lists of errors, with its interval; `None` for an empty list, for an
/// error that is not finite, or if all errors of a list are 0.
pub fn error_ratio(above: &[f64], below: &[f64], level: f64) -> Option<Estimate> {
    if !is_level(level) || !all_finite(above) || !all_finite(below) {
        return None;
    }
    let mean_square = |errors: &[f64]| errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64;
    let squared = Some(mean_square(above) / mean_square(below)).filter(|ratio| ratio.is_finite() && *ratio > 0.0)?;
    let distribution = FisherSnedecor::new(above.len() as f64, below.len() as f64).ok()?;
    let quantile = |p: f64| distribution.inverse_cdf(p);
    let (low, high) = (quantile(0.5 * (1.0 - level)), quantile(0.5 * (1.0 + level)));
    let interval = Interval::between((squared / high).sqrt(), (squared / low).sqrt(), level)?;
    Some(Estimate { value: squared.sqrt(), interval })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use rand_pcg::Pcg64Dxsm;

    /// F(2, 2) has the distribution function x / (1 + x), so its quantile is p / (1 - p).
    #[test]
    fn the_interval_is_fishers() {
        let found = error_ratio(&[3.0, -4.0], &[0.6, 0.8], 0.95).unwrap();
        let quantile = 0.975 / 0.025_f64;
        assert!((found.value - 5.0).abs() < 1e-12);
        assert!((found.interval.low - 5.0 / quantile.sqrt()).abs() < 1e-6, "{found:?}");
        assert!((found.interval.high - 5.0 * quantile.sqrt()).abs() < 1e-6, "{found:?}");
    }

    /// F(2, 4) has the distribution function 1 - 1 / (1 + x / 2)^2; F(4, 2) is the reciprocal. So the two sides are told apart.
    #[test]
    fn each_list_has_its_own_number_of_errors() {
        let found = error_ratio(&[1.0, -1.0], &[1.0, 1.0, -1.0, -1.0], 0.9).unwrap();
        let quantile = |p: f64| 2.0 * (1.0 / (1.0 - p).sqrt() - 1.0);
        assert!((found.interval.low - 1.0 / quantile(0.95).sqrt()).abs() < 1e-6, "{found:?}");
        assert!((found.interval.high - 1.0 / quantile(0.05).sqrt()).abs() < 1e-6, "{found:?}");
    }

    /// Level of the test: with a coverage of exactly 95 %, fewer than 1855 of 2000 have a probability below 1e-4, and the seed
    /// is fixed.
    #[test]
    fn intervals_cover_the_ratio() {
        let mut generator = Pcg64Dxsm::new(5, 1);
        let mut unit = || ((generator.next_u64() >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0;
        let mut normal = || (-2.0 * libm::log(unit())).sqrt() * libm::cos(std::f64::consts::TAU * unit());
        let mut errors = |count: usize, spread: f64| (0..count).map(|_| spread * normal()).collect::<Vec<f64>>();
        let covered = (0..2000).filter(|_| {
            let (above, below) = (errors(16, 2.0), errors(12, 1.0));
            error_ratio(&above, &below, 0.95).unwrap().interval.contains(2.0)
        });
        let covered = covered.count();
        assert!((1855..=1945).contains(&covered), "{covered} of 2000");
    }

    #[test]
    fn errors_without_an_answer_have_none() {
        for (above, below) in
            [(&[][..], &[1.0][..]), (&[1.0], &[]), (&[0.0], &[1.0]), (&[1.0], &[0.0]), (&[f64::NAN], &[1.0])]
        {
            assert_eq!(error_ratio(above, below, 0.95), None);
        }
        assert_eq!(error_ratio(&[1.0], &[1.0], 1.0), None);
    }
}
