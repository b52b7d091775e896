//! Values with their intervals.

use crate::analysis::confidence_sequence::Stopping;
use crate::analysis::mean::{Moments, geometric_interval, t_interval};
use crate::analysis::mse::over_seeds;
use crate::analysis::quantile::median;
use crate::analysis::{Estimate, Interval};
use crate::plot::{Dot, Point};
use serde::Serialize;

/// Confidence of every interval in the report.
pub const LEVEL: f64 = 0.95;

/// The root of the mean, not the mean of roots, as the cross form requires. NaN, which charts leave out, if the mean is
/// negative.
pub(super) fn root_of_mean(mse: &[f64]) -> f64 {
    (mse.iter().sum::<f64>() / mse.len() as f64).sqrt()
}

/// A value and its interval, if there were enough values for one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimated {
    pub value: f64,
    pub interval: Option<Interval>,
    /// The number of values that it was computed from, if counted.
    pub(super) count: Option<usize>,
    /// Whether it lacks repetitions that the values beside it have.
    pub(super) is_partial: bool,
}

impl From<Estimate> for Estimated {
    fn from(Estimate { value, interval }: Estimate) -> Self {
        Self::of(value, Some(interval))
    }
}

impl Estimated {
    pub(super) fn of(value: f64, interval: Option<Interval>) -> Self {
        Self { value, interval, count: None, is_partial: false }
    }

    /// The typical value of some values, by one rule: the median if its distribution-free interval reaches the confidence
    /// of the report, which takes six values. Fewer have their geometric mean with Student's interval of the logarithms,
    /// or their mean if one of them is not positive. A single value has no interval.
    pub(super) fn typical(values: &[f64], stopping: Stopping) -> Option<Self> {
        let ordered = stopping.median_interval(values, LEVEL);
        let of_few = || {
            let is_positive = values.iter().all(|value| *value > 0.0);
            if is_positive { geometric_interval(values, LEVEL) } else { t_interval(values, LEVEL) }
        };
        let own = match ordered {
            Some(interval) if interval.level >= LEVEL => Self::of(median(values)?, ordered),
            // Equal values have no spread, so Student's interval does not exist.
            _ => of_few().map_or(Self::of(median(values)?, ordered), Self::from),
        };
        Some(Self { count: Some(values.len()), ..own })
    }

    /// The mean of values of equal variance, with Student's interval.
    pub(super) fn mean(values: &[f64]) -> Option<Self> {
        let interval = t_interval(values, LEVEL).map(|estimate| estimate.interval);
        Some(Self { count: Some(values.len()), ..Self::of(Moments::of(values).mean()?, interval) })
    }

    /// The error of images with these squared errors, one for each seed.
    pub(super) fn rmse(mse: &[f64]) -> Self {
        let interval = over_seeds(mse, LEVEL).map(|error| error.rmse.interval);
        Self { count: Some(mse.len()), ..Self::of(root_of_mean(mse), interval) }
    }

    /// The same value in another unit.
    pub(super) fn times(&self, factor: f64) -> Self {
        let times = |i: Interval| Interval { low: factor * i.low, high: factor * i.high, level: i.level };
        Self { value: factor * self.value, interval: self.interval.map(times), ..*self }
    }

    /// The ends of the interval.
    pub(super) fn bar(&self) -> Option<(f64, f64)> {
        self.interval.map(|interval| (interval.low, interval.high))
    }

    pub(super) fn dot(&self) -> Dot {
        Dot { value: self.value, interval: self.bar(), count: self.count, hollow: self.is_partial }
    }

    pub(super) fn above(&self, x: f64) -> Point {
        Point { count: self.count, hollow: self.is_partial, ..Point::new(x, self.value).with_y(self.bar()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typical(values: &[f64]) -> Estimated {
        Estimated::typical(values, Stopping::Fixed).unwrap()
    }

    /// Logarithms 0, 1 and 2 in units of ln 2 have the mean 1 and the standard error 1 / sqrt(3); Student's t with two
    /// degrees of freedom is 4.30265.
    #[test]
    fn few_values_have_their_geometric_mean_at_the_full_confidence() {
        let three = typical(&[1.0, 2.0, 4.0]);
        let ends = three.interval.unwrap();
        assert!((three.value - 2.0).abs() < 1e-12 && ends.level >= LEVEL);
        assert!((libm::log2(ends.high / 2.0) - 4.302_65 / 3.0_f64.sqrt()).abs() < 1e-4, "{ends:?}");
        let six = typical(&[1.0, 2.0, 3.0, 4.0, 5.0, 60.0]);
        assert_eq!((six.value, six.bar(), six.count), (3.5, Some((1.0, 60.0)), Some(6)));
        let negative = typical(&[-1.0, 0.0, 1.0]);
        assert!(negative.value.abs() < 1e-12 && negative.interval.unwrap().level >= LEVEL);
        assert_eq!((typical(&[3.0]).interval, typical(&[2.0; 3]).bar()), (None, Some((2.0, 2.0))));
    }
}
