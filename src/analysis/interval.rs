//! An interval with the confidence it really has, and an estimate that carries one.

use serde::Serialize;

/// A two-sided confidence interval, in the unit of what it bounds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// The confidence reached, in (0, 1). It may be above or below what was asked for where only a few levels exist.
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

    /// Whether `value` lies in the interval, ends included.
    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }
}

/// An estimate and how far it can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Where the true value lies with the interval's confidence.
    pub interval: Interval,
}

/// Whether `level` can be a confidence: in (0, 1), ends excluded.
pub(crate) fn is_level(level: f64) -> bool {
    level > 0.0 && level < 1.0
}

/// Whether every value is finite.
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
    fn nonsense_is_no_interval() {
        assert_eq!(Interval::around(f64::NAN, 1.0, 0.95), None);
        assert_eq!(Interval::around(1.0, f64::INFINITY, 0.95), None);
        assert_eq!(Interval::between(2.0, 1.0, 0.95), None);
        assert!(!is_level(0.0) && !is_level(1.0) && !is_level(f64::NAN) && is_level(0.95));
    }
}
