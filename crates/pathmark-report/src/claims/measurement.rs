//! Measured values, each with its interval, the number of independent units behind it, and the rule that made the interval.

use crate::analysis::adjacent_pairs::{FEWEST_PROCESSES, FEWEST_TRIMMED, paired_ratio};
use crate::analysis::mean::{Moments, fewest_values, geometric_interval, t_interval, t_quantile};
use crate::plot::number::{fixed, is_plain, short};
use crate::prelude::*;

/// Fewest units for which the extremes enclose the median with 95 % confidence: 1 - 2 / 2^6 is 0.969.
const ENOUGH: usize = 6;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Measurement {
    pub(super) value: f64,
    /// `None` for a single unit.
    pub(super) interval: Option<Interval>,
    /// The number of independent units.
    pub(super) units: usize,
    /// A unit in a word: `repetition`.
    pub(super) noun: &'static str,
    pub(super) rule: Rule,
    /// The standard deviation of the units, of their logarithms if the value is a ratio.
    pub(super) deviation: Option<f64>,
    pub(super) scale: Scale,
}

/// The scale on which values are averaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scale {
    Linear,
    /// For ratios, which cannot be negative.
    Logarithmic,
}

/// The rule that made value and interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rule {
    /// The median; its interval ends at order statistics.
    Median,
    /// The mean, or the geometric mean of ratios, with the interval of Student's t.
    Mean,
    /// The ratio of adjacent pairs over processes, as figures and tables have it.
    Pairs,
    /// A ratio of two means with the interval of Student's t and Welch's degrees of freedom.
    Welch {
        /// The units of the side that has more; those of the other side count.
        others: usize,
    },
    /// A line through points with the interval of Student's t.
    Line,
    /// An interval from leaving out one seed after the other.
    Jackknife,
    /// A rank correlation with Fisher's interval.
    Ranks,
    /// A count, or a value that all units share: no error.
    Exact,
    /// The hull of intervals that other tables give.
    Hull,
}

impl Scale {
    fn of(self, value: f64) -> f64 {
        if self == Self::Linear { value } else { libm::log(value) }
    }

    /// The mean, or the geometric mean of positive values.
    pub(super) fn mean(self, values: &[f64]) -> Option<f64> {
        let mean = Moments::of(&values.iter().map(|value| self.of(*value)).collect::<Vec<_>>()).mean()?;
        Some(if self == Self::Linear { mean } else { libm::exp(mean) })
    }
}

impl Measurement {
    /// The typical value of some units by the one rule for intervals: from six units on the median between order statistics,
    /// below that the mean with Student's t, and no interval for a single unit.
    pub(super) fn typical(
        values: &[f64],
        scale: Scale,
        stopping: Stopping,
        level: f64,
        noun: &'static str,
    ) -> Option<Self> {
        let first = *values.first()?;
        let scaled: Vec<f64> = values.iter().map(|value| scale.of(*value)).collect();
        let deviation = Moments::of(&scaled).sample_variance().map(f64::sqrt);
        let of = |value, interval, rule| Self { value, interval, units: values.len(), noun, rule, deviation, scale };
        if values.len() > 1 && values.iter().all(|value| *value == first) {
            return Some(of(first, Interval::between(first, first, 1.0), Rule::Exact));
        }
        let enough =
            stopping.median_interval(values, level).filter(|found| values.len() >= ENOUGH && found.level >= level);
        if enough.is_some() {
            return Some(of(median(values)?, enough, Rule::Median));
        }
        let of_few = match scale {
            Scale::Linear => t_interval(values, level),
            Scale::Logarithmic => geometric_interval(values, level),
        };
        Some(of(scale.mean(values)?, of_few.map(|few| few.interval), Rule::Mean))
    }

    /// The ratio from the values of some processes that ran pairs; see [`paired_ratio`].
    pub(super) fn of_pairs(processes: &[f64], level: f64, noun: &'static str) -> Option<Self> {
        let each: Vec<Vec<f64>> = processes.iter().map(|value| vec![*value]).collect();
        let found = paired_ratio(&each, level)?;
        let Estimate { value, interval } = found.ratio;
        let (rule, scale) = (Rule::Pairs, Scale::Logarithmic);
        let deviation = Some(found.spread.between);
        Some(Self { value, interval: Some(interval), units: found.processes, noun, rule, deviation, scale })
    }

    /// An estimate that has an interval of its own.
    pub(super) fn estimate(estimate: Option<Estimate>, rule: Rule, units: usize, noun: &'static str) -> Option<Self> {
        let Estimate { value, interval } = estimate?;
        let scale = if matches!(rule, Rule::Welch { .. }) { Scale::Logarithmic } else { Scale::Linear };
        let half_width = 0.5 * (scale.of(interval.high) - scale.of(interval.low));
        // The deviation of so many units whose mean would have this interval.
        let t = t_quantile(interval.level, units.saturating_sub(1));
        let deviation = t.map(|t| half_width * (units as f64).sqrt() / t);
        Some(Self { value, interval: Some(interval), units, noun, rule, deviation, scale })
    }

    /// A counted value, which has no error.
    pub(super) fn exact(value: f64, units: usize, noun: &'static str) -> Option<Self> {
        let interval = Interval::between(value, value, 1.0);
        let found = Self { value, interval, units, noun, rule: Rule::Exact, deviation: None, scale: Scale::Linear };
        (units > 0).then_some(found)
    }

    /// A value with the interval of another table.
    pub(super) fn of_table(value: f64, interval: Option<Interval>, units: usize, noun: &'static str) -> Self {
        Self { value, interval, units, noun, rule: Rule::Hull, deviation: None, scale: Scale::Linear }
    }

    /// Several measurements of one thing, each with an interval of another table: their median, and the hull of their intervals.
    pub(super) fn hull(all: &[Self]) -> Option<Self> {
        let first = *all.first()?;
        let ends = all.iter().map(|one| one.interval).collect::<Option<Vec<Interval>>>();
        let interval = ends.and_then(|ends| {
            let low = ends.iter().map(|end| end.low).fold(f64::INFINITY, f64::min);
            let high = ends.iter().map(|end| end.high).fold(f64::NEG_INFINITY, f64::max);
            let level = ends.iter().map(|end| end.level).fold(1.0, f64::min);
            Interval::between(low, high, level)
        });
        let value = median(&all.iter().map(|one| one.value).collect::<Vec<_>>())?;
        // Each run counts the same things again.
        let counts = all.iter().map(|one| one.units);
        let units = if first.rule == Rule::Exact { counts.max()? } else { counts.sum() };
        Some(Self { value, interval, units, ..first })
    }

    /// Whether it can be compared with a prediction alone: two units have a t of 12.7, so only together with others they say
    /// something.
    pub(super) fn stands_alone(&self) -> bool {
        self.rule != Rule::Mean || self.units >= FEWEST_PROCESSES
    }

    /// How many more units would decide, by their spread, on which side of the prediction the value lies; `None` if that cannot
    /// be told.
    pub(super) fn units_to_settle(&self, [low, high]: [f64; 2], level: f64) -> Option<usize> {
        let distance = |end: f64| (self.scale.of(self.value) - self.scale.of(end)).abs();
        let nearest = [low, high].into_iter().filter(|end| end.is_finite()).map(distance).reduce(f64::min)?;
        let all = fewest_values(self.deviation?, nearest, level)?;
        Some(all.saturating_sub(self.units).max(1))
    }

    /// The value with its interval: with three digits, or as many as tell the ends from each other and the width to a quarter.
    pub(super) fn shown(&self) -> String {
        let Some(Interval { low, high, .. }) = self.interval else {
            return format!("{} (one {}, no interval)", short(self.value, DIGITS), self.noun);
        };
        if low == high {
            return short(self.value, DIGITS);
        }
        let place = |value: f64| libm::log10(value).floor();
        let largest = place(low.abs().max(high.abs()));
        let last = place(0.25 * (high - low)).min(largest + 1.0 - DIGITS as f64).max(largest - MOST_DIGITS);
        let all = [self.value, low, high];
        let [value, low, high] = if all.into_iter().all(is_plain) {
            all.map(|number| fixed(number, (-last).max(0.0) as usize))
        } else {
            all.map(|number| short(number, (largest - last + 1.0) as usize))
        };
        format!("{value} ({low} to {high})")
    }

    /// The confidence of the interval; empty for a value without error or without interval.
    pub(super) fn confidence(&self) -> String {
        let uncertain = self.interval.filter(|interval| interval.level < 1.0);
        uncertain.map_or_else(String::new, |interval| format!("{:.1} %", interval.percent()))
    }

    /// The rule that made value and interval, and the number of units.
    pub(super) fn rule_in_words(&self) -> String {
        let units = counted(self.units, self.noun);
        match self.rule {
            _ if self.interval.is_none() => format!("{units}, too few for an interval"),
            Rule::Median => format!("median of {units}, interval between order statistics"),
            Rule::Mean if self.scale == Scale::Logarithmic => {
                format!("geometric mean of {units}, interval of Student's t of logarithms")
            }
            Rule::Pairs if self.units >= FEWEST_TRIMMED => {
                format!(
                    "geometric mean of {units} without the eighth at either end, interval of Student's t of logarithms"
                )
            }
            Rule::Pairs => format!("geometric mean of {units}, interval of Student's t of logarithms"),
            Rule::Mean => format!("mean of {units}, interval of Student's t"),
            Rule::Welch { others } => {
                format!("{units} beside {others}, interval of Student's t with Welch's degrees of freedom")
            }
            Rule::Line => format!("line through {units}, interval of Student's t"),
            Rule::Jackknife => format!("{units}, interval by leaving out one after the other"),
            Rule::Ranks => format!("{units}, interval by Fisher's transformation"),
            Rule::Exact => format!("{units}, no error"),
            Rule::Hull => format!("{units}, interval of the table or forecast"),
        }
    }
}

const DIGITS: usize = 3;
const MOST_DIGITS: f64 = 12.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f64]) -> Measurement {
        Measurement::typical(values, Scale::Logarithmic, Stopping::Fixed, 0.95, "repetition").unwrap()
    }

    /// Five values have the interval of their geometric mean, six reach from the least to the largest.
    #[test]
    fn one_rule_for_intervals_of_few_values() {
        let five = of(&[1.0, 1.1, 1.2, 1.3, 4.0]);
        assert_eq!((five.rule, five.units), (Rule::Mean, 5));
        let product: f64 = 1.1 * 1.2 * 1.3 * 4.0;
        assert!((five.value - libm::pow(product, 0.2)).abs() < 1e-12);
        let six = of(&[1.0, 1.1, 1.2, 1.3, 4.0, 1.15]);
        let ends = six.interval.unwrap();
        assert_eq!((six.rule, ends.low, ends.high), (Rule::Median, 1.0, 4.0));
        assert_eq!(six.confidence(), "96.8 %");
        let one = of(&[2.0]);
        assert_eq!((one.interval, one.shown()), (None, "2 (one repetition, no interval)".to_string()));
        assert_eq!(of(&[2.0, 2.0]).rule, Rule::Exact);
        let names = [five, six, one].map(|found| found.rule_in_words());
        assert!(names[0].contains("Student") && names[1].contains("median of 6 repetitions"), "{names:?}");
    }

    #[test]
    fn ends_are_told_apart() {
        let interval = Interval::between(0.999_78, 0.999_91, 0.95);
        let found = Measurement { value: 0.999_85, interval, ..of(&[1.0, 2.0]) };
        assert_eq!(found.shown(), "0.99985 (0.99978 to 0.99991)");
        let wide = Measurement { value: 1.608, interval: Interval::between(1.568, 1.667, 0.95), ..found };
        assert_eq!(wide.shown(), "1.61 (1.57 to 1.67)");
        let coarse = Measurement { value: 0.0432, interval: Interval::between(0.0395, 0.0493, 0.95), ..found };
        assert_eq!(coarse.shown(), "0.0432 (0.0395 to 0.0493)");
        let around = Measurement { value: 0.0, interval: Interval::between(-0.587, 0.587, 0.95), ..found };
        assert_eq!(around.shown(), "0.000 (−0.587 to 0.587)");
        let about_one = Measurement { value: 1.0, interval: Interval::between(0.9902, 1.009_89, 0.95), ..found };
        assert_eq!(about_one.shown(), "1.000 (0.990 to 1.010)");
        let tiny = Measurement { value: 1.99e-11, interval: Interval::between(1.93e-11, 2.05e-11, 0.95), ..found };
        assert_eq!(tiny.shown(), "1.99×10⁻¹¹ (1.93×10⁻¹¹ to 2.05×10⁻¹¹)");
    }

    /// Values 1 apart from the bound with a deviation of 1: Student's half width of 7 is 0.925, that of 6 is 1.049.
    #[test]
    fn the_units_that_would_settle_a_claim() {
        let found = Measurement { value: 2.0, deviation: Some(1.0), scale: Scale::Linear, ..of(&[1.0, 2.0, 3.0]) };
        assert_eq!(found.units_to_settle([3.0, f64::INFINITY], 0.95), Some(4));
        assert_eq!(found.units_to_settle([f64::NEG_INFINITY, 2.0], 0.95), None, "on the bound");
        assert_eq!(found.units_to_settle([2.9, 100.0], 0.95), Some(5));
    }
}
