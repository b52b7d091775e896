//! Confidence intervals with the level that they reach, and estimates that carry one.

use serde::Serialize;

/// A two-sided confidence interval, in the unit of the estimated value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
    /// The confidence reached, in (0, 1). It may be above or below the requested level where only a few levels exist.
    pub level: f64,
}

impl Interval {
    /// An interval of `half_width` to either side of `centre`; `None` if an end is not finite.
    pub fn around(centre: f64, half_width: f64, level: f64) -> Option<Self> {
        Self::between(centre - half_width, centre + half_width, level)
    }

    /// The interval from `low` to `high`; `None` if an end is not finite or they are in the wrong order.
    pub fn between(low: f64, high: f64, level: f64) -> Option<Self> {
        (low.is_finite() && high.is_finite() && low <= high).then_some(Self { low, high, level })
    }

    /// The confidence in percent as every text tells it: rounded down to one decimal, so that it is never told larger than it is.
    /// Binomial sums may give a half as .4999999, which still counts as a half.
    pub fn percent(&self) -> f64 {
        (self.level * 1000.0 + 1e-6).floor() / 10.0
    }

    /// Whether `value` lies in the interval, ends included.
    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    pub value: f64,
    pub interval: Interval,
}

impl Estimate {
    /// Returns the product of two independent estimates of positive values. The distances between values and ends, as
    /// logarithms, add up in squares, as errors do. `None` for a value or an end that is not positive, or for different
    /// levels.
    pub fn times(&self, other: &Self) -> Option<Self> {
        let level = Some(self.interval.level).filter(|&level| level == other.interval.level)?;
        let ends = |estimate: &Self| {
            let all = [estimate.interval.low, estimate.value, estimate.interval.high];
            all.iter().all(|&end| end > 0.0).then(|| all.map(libm::log))
        };
        let ([low, value, high], [other_low, other_value, other_high]) = (ends(self)?, ends(other)?);
        let centre = value + other_value;
        let (down, up) =
            (libm::hypot(value - low, other_value - other_low), libm::hypot(high - value, other_high - other_value));
        Self { value: centre, interval: Interval { low: centre - down, high: centre + up, level } }.exp()
    }

    /// Returns the estimate of the value whose logarithm this is; `None` if an end is not finite.
    pub fn exp(&self) -> Option<Self> {
        let Interval { low, high, level } = self.interval;
        Some(Self {
            value: libm::exp(self.value),
            interval: Interval::between(libm::exp(low), libm::exp(high), level)?,
        })
    }

    /// Returns the reciprocal; `None` for a value or an end that is not positive.
    pub fn inverse(&self) -> Option<Self> {
        let interval = Interval::between(1.0 / self.interval.high, 1.0 / self.interval.low, self.interval.level)?;
        (self.value > 0.0 && self.interval.low > 0.0).then(|| Self { value: 1.0 / self.value, interval })
    }
}

/// Whether `level` can be a confidence: in (0, 1), ends excluded.
pub(crate) fn is_level(level: f64) -> bool {
    level > 0.0 && level < 1.0
}

pub(crate) fn all_finite(values: &[f64]) -> bool {
    values.iter().all(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_belong_to_the_interval() {
        let interval = Interval::around(2.0, 0.5, 0.95).unwrap();
        assert!(interval.contains(1.5) && interval.contains(2.5));
        assert!(!interval.contains(2.51) && !interval.contains(f64::NAN));
    }

    #[test]
    fn a_confidence_is_not_told_larger_than_it_is() {
        let percent = |level: f64| Interval { low: 0.0, high: 1.0, level }.percent();
        assert_eq!([0.5 - 1e-12, 0.5, 0.9299, 0.96, 0.96875].map(percent), [50.0, 50.0, 92.9, 96.0, 96.8]);
    }

    #[test]
    fn nonsense_is_no_interval() {
        assert_eq!(Interval::around(f64::NAN, 1.0, 0.95), None);
        assert_eq!(Interval::around(1.0, f64::INFINITY, 0.95), None);
        assert_eq!(Interval::between(2.0, 1.0, 0.95), None);
        assert!(!is_level(0.0) && !is_level(1.0) && !is_level(f64::NAN) && is_level(0.95));
    }

    #[test]
    fn errors_of_factors_add_up_in_squares() {
        // Logarithmic half widths of 0.3 and 0.4 add up in squares to 0.5.
        let estimate = |value: f64, factor: f64| Estimate {
            value,
            interval: Interval { low: value / factor, high: value * factor, level: 0.95 },
        };
        let product = estimate(2.0, libm::exp(0.3)).times(&estimate(5.0, libm::exp(0.4))).unwrap();
        assert!((product.value - 10.0).abs() < 1e-12 && (product.interval.high - 10.0 * libm::exp(0.5)).abs() < 1e-12);
        assert!((product.interval.low - 10.0 * libm::exp(-0.5)).abs() < 1e-12);
        let inverse = product.inverse().unwrap();
        assert!(
            (inverse.value - 0.1).abs() < 1e-15 && (inverse.interval.high * product.interval.low - 1.0).abs() < 1e-12
        );
        let zero = Estimate { value: 0.0, interval: Interval { low: -1.0, high: 1.0, level: 0.95 } };
        assert_eq!((zero.times(&product), product.times(&zero), zero.inverse()), (None, None, None));
    }
}
