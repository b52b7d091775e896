//! Doubtful times: the number of rows that have them, and the reasons.

use serde::Serialize;
use std::fmt;

/// The warnings about the time of a run; the others concern its image.
const REASONS: [&str; 5] = ["foreign-load", "steal", "slowed", "drift", "too-short"];

/// The number of rows, and of those whose times are in doubt; in JSON only the latter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(into = "usize")]
pub struct TimingConcerns {
    rows: usize,
    doubted: usize,
    /// Number of rows with each reason; a row may have several.
    by_reason: [usize; REASONS.len()],
}

impl From<TimingConcerns> for usize {
    fn from(concerns: TimingConcerns) -> Self {
        concerns.doubted
    }
}

impl TimingConcerns {
    /// The doubts about some rows, given the column `warnings` of each.
    pub fn of<'a>(rows: impl IntoIterator<Item = &'a str>) -> Self {
        let mut doubts = Self::default();
        rows.into_iter().for_each(|warnings| doubts.add(warnings));
        doubts
    }

    /// Whether the time of a row with these warnings is in doubt.
    pub fn concern(warnings: &str) -> bool {
        REASONS.iter().any(|reason| warnings.contains(reason))
    }

    pub fn add(&mut self, warnings: &str) {
        self.rows += 1;
        self.doubted += usize::from(Self::concern(warnings));
        for (count, reason) in self.by_reason.iter_mut().zip(REASONS) {
            *count += usize::from(warnings.contains(reason));
        }
    }

    pub fn merge(&mut self, other: &Self) {
        self.rows += other.rows;
        self.doubted += other.doubted;
        for (count, more) in self.by_reason.iter_mut().zip(other.by_reason) {
            *count += more;
        }
    }

    pub fn rows(&self) -> usize {
        self.rows
    }

    pub fn count(&self) -> usize {
        self.doubted
    }

    pub fn is_any(&self) -> bool {
        self.doubted > 0
    }

    /// Whether a tenth of the rows or more are in doubt.
    pub fn is_high(&self) -> bool {
        self.is_any() && 10 * self.doubted >= self.rows
    }
}

impl fmt::Display for TimingConcerns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rows, doubted, by_reason } = self;
        let reasons = by_reason.iter().zip(REASONS).filter(|(count, _)| **count > 0);
        let reasons: Vec<String> = reasons.map(|(count, reason)| format!("{count} {reason}")).collect();
        let verb = if *doubted == 1 { "has a time" } else { "have times" };
        write!(f, "{doubted} of {rows} rows {verb} in doubt")?;
        if reasons.is_empty() { Ok(()) } else { write!(f, " ({})", reasons.join(", ")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::WARNINGS;

    #[test]
    fn rows_are_counted_once_and_reasons_each() {
        let mut doubts = TimingConcerns::of(["", "drift(+30 %);slowed(+20 % CPU)", "biased"]);
        assert_eq!(doubts.to_string(), "1 of 3 rows has a time in doubt (1 slowed, 1 drift)");
        assert!(doubts.is_any() && doubts.is_high());
        doubts.merge(&TimingConcerns::of(vec![""; 8]));
        assert_eq!((doubts.is_any(), doubts.is_high()), (true, false));
        doubts.add("too-short");
        assert_eq!(doubts.to_string(), "2 of 12 rows have times in doubt (1 slowed, 1 drift, 1 too-short)");
        assert!(doubts.is_high() && !TimingConcerns::of(["biased"]).is_any() && !TimingConcerns::default().is_high());
    }

    #[test]
    fn reasons_are_warnings() {
        for reason in REASONS {
            assert!(WARNINGS.iter().any(|entry| entry.name == reason), "{reason}");
        }
    }
}
