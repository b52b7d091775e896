//! An error with its confidence interval.

use crate::analysis::mean::t_interval;
use crate::guard_prices::LEVEL;
use serde::{Deserialize, Serialize};

/// A number with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

/// Normal quantile of a two-sided interval of 95 %.
const Z: f64 = 1.959_963_984_540_054;

impl Measured {
    /// The mean of some numbers. Equal numbers give an interval of width zero.
    pub(super) fn mean(values: &[f64]) -> Self {
        let exactly = |value| Self { value, low: value, high: value };
        t_interval(values, LEVEL).map_or_else(
            || exactly(values.first().copied().unwrap_or(f64::NAN)),
            |mean| Self { value: mean.value, low: mean.interval.low.max(0.0), high: mean.interval.high },
        )
    }

    /// The share of `count` in `all`, with the interval of E. B. Wilson, "Probable inference, the law of succession,
    /// and statistical inference", Journal of the American Statistical Association 22 (1927). A count of zero has a
    /// positive upper end there.
    pub(super) fn share(count: u64, all: u64) -> Self {
        let (n, value) = (all as f64, count as f64 / all as f64);
        let scale = 1.0 + Z * Z / n;
        let centre = (value + Z * Z / (2.0 * n)) / scale;
        let half_width = Z / scale * (value * (1.0 - value) / n + Z * Z / (4.0 * n * n)).sqrt();
        let low = if count == 0 { 0.0 } else { centre - half_width };
        Self { value, low, high: if count == all { 1.0 } else { centre + half_width } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares() {
        // Wilson's interval from tables: 0.0552 to 0.1744 for 10 in 100, 0 to 0.0370 for none in 100.
        let ten = Measured::share(10, 100);
        assert!((ten.low - 0.0552).abs() < 1e-4 && (ten.high - 0.1744).abs() < 1e-4, "{ten:?}");
        let none = Measured::share(0, 100);
        assert!(none.low == 0.0 && (none.high - 0.0370).abs() < 1e-4, "{none:?}");
    }

    #[test]
    fn means() {
        assert_eq!(Measured::mean(&[2.0, 2.0]), Measured { value: 2.0, low: 2.0, high: 2.0 });
        // Student's t for 2 degrees of freedom is 4.3027; s = 1.
        let mean = Measured::mean(&[4.0, 5.0, 6.0]);
        assert!((mean.high - (5.0 + 4.3027 / 3.0_f64.sqrt())).abs() < 1e-3, "{mean:?}");
    }
}
