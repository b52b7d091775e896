//! Values with their intervals.

use crate::analysis::confidence_sequence::Stopping;
use crate::analysis::mean::{Moments, t_interval};
use crate::analysis::quantile::median;
use crate::analysis::{Estimate, Interval};
use crate::plot::{Dot, Point};
use serde::Serialize;

/// Confidence of every interval in the report.
pub const LEVEL: f64 = 0.95;

/// A value and its interval, if there were enough values for one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct Estimated {
    pub(super) value: f64,
    pub(super) interval: Option<Interval>,
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

    /// The median of some values with its distribution-free interval.
    pub(super) fn median(values: &[f64], stopping: Stopping) -> Option<Self> {
        let interval = stopping.median_interval(values, LEVEL);
        Some(Self { count: Some(values.len()), ..Self::of(median(values)?, interval) })
    }

    /// The mean of values of equal variance, with Student's interval.
    pub(super) fn mean(values: &[f64]) -> Option<Self> {
        let interval = t_interval(values, LEVEL).map(|estimate| estimate.interval);
        Some(Self { count: Some(values.len()), ..Self::of(Moments::of(values).mean()?, interval) })
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
