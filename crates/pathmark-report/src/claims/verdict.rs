//! Verdicts: the comparison of a measured interval with the prediction of a claim.

use super::measurement::Measurement;
use std::fmt;

/// The verdicts on claims with a prediction, and then that of findings, which have none.
pub(super) const NAMES: [&str; 7] =
    ["confirmed", "refuted", "open", "not-comparable", "not-answered", "context", "measured"];

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The whole interval lies within the prediction.
    Confirmed,
    /// The interval and the prediction do not overlap.
    Refuted,
    /// The interval lies partly within the prediction, or there is none.
    Open,
    /// The rows were measured under conditions that differ from the report's.
    NotComparable,
    /// There are no rows.
    NotAnswered,
    /// There is nothing to measure.
    Context,
    /// A finding, which predicts nothing.
    Measured,
}

impl Verdict {
    pub fn name(self) -> &'static str {
        NAMES[self as usize]
    }

    pub(super) fn named(name: &str) -> Option<Self> {
        let judged = [Self::Confirmed, Self::Refuted, Self::Open, Self::NotComparable, Self::NotAnswered];
        let mut all = judged.into_iter().chain([Self::Context, Self::Measured]);
        all.find(|verdict| verdict.name() == name)
    }

    /// How much it says about the claim: of two answers, the larger one counts.
    pub(super) fn says(self) -> u8 {
        match self {
            Self::NotAnswered | Self::Context => 0,
            Self::NotComparable => 1,
            Self::Confirmed | Self::Refuted | Self::Open | Self::Measured => 2,
        }
    }

    /// Compares a measurement with the ends of the prediction.
    pub(super) fn of(found: &Measurement, [low, high]: [f64; 2]) -> Self {
        match found.interval {
            Some(interval) if low <= interval.low && interval.high <= high => Self::Confirmed,
            Some(interval) if interval.high < low || high < interval.low => Self::Refuted,
            _ => Self::Open,
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name().replace('-', " "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::Interval;

    fn of(low: f64, high: f64, predicted: [f64; 2]) -> Verdict {
        let interval = Interval::between(low, high, 0.95);
        Verdict::of(&Measurement::of_table(0.5 * (low + high), interval, 9, "row"), predicted)
    }

    #[test]
    fn names_are_in_the_order_of_the_verdicts() {
        assert_eq!(Verdict::Confirmed.name(), "confirmed");
        assert_eq!(Verdict::Context.name(), "context");
        assert_eq!(Verdict::named("measured"), Some(Verdict::Measured));
        assert_eq!(Verdict::NotAnswered.to_string(), "not answered");
    }

    #[test]
    fn the_whole_interval_decides() {
        assert_eq!(of(0.95, 1.05, [0.9, 1.1]), Verdict::Confirmed);
        assert_eq!(of(0.9, 1.1, [0.9, 1.1]), Verdict::Confirmed);
        assert_eq!(of(0.89, 1.05, [0.9, 1.1]), Verdict::Open);
        assert_eq!(of(0.5, 2.0, [0.9, 1.1]), Verdict::Open);
        assert_eq!(of(0.5, 0.8, [0.9, 1.1]), Verdict::Refuted);
        assert_eq!(of(1.2, 1.3, [0.9, 1.1]), Verdict::Refuted);
        assert_eq!(of(1.2, 1.3, [0.9, f64::INFINITY]), Verdict::Confirmed);
        assert_eq!(of(-1.2, 0.3, [f64::NEG_INFINITY, 0.2]), Verdict::Open);
    }

    #[test]
    fn a_single_value_decides_nothing() {
        assert_eq!(Verdict::of(&Measurement::of_table(1.0, None, 1, "row"), [0.9, 1.1]), Verdict::Open);
    }
}
