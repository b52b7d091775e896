//! A machine that becomes faster or slower while a sweep runs.

use crate::measure::{Record, Warning, median};
use std::collections::HashMap;

/// Earlier rows of a cell that are enough to say what it usually takes.
const ENOUGH: usize = 3;
/// Relative difference from the median so far from which a row is suspected.
const SUSPICIOUS: f64 = 0.25;

/// The times of each cell so far.
pub(super) struct Drift(HashMap<String, Vec<f64>>);

impl Drift {
    /// Knows the rows of an earlier part of the sweep.
    pub(super) fn of(done: &[Record]) -> Self {
        let mut drift = Self(HashMap::new());
        for record in done {
            drift.note(record);
        }
        drift
    }

    fn note(&mut self, record: &Record) {
        if let Some(makespan_s) = record.makespan_s {
            self.0.entry(record.cell.clone()).or_default().push(makespan_s);
        }
    }

    /// Warns of a row whose time is far from that of its cell's earlier rows.
    pub(super) fn watch(&mut self, record: &mut Record) {
        let before = self.0.get(&record.cell).filter(|times| times.len() >= ENOUGH).and_then(|times| median(&mut times.clone()));
        if let Some((makespan_s, usual_s)) = record.makespan_s.zip(before) {
            let change = makespan_s / usual_s - 1.0;
            if change.abs() > SUSPICIOUS {
                record.warn(Warning::Drift { percent: (100.0 * change).round() as i32 });
            }
        }
        self.note(record);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_far_from_the_earlier_ones_is_marked() {
        let row = |makespan_s| Record { cell: "a".into(), makespan_s: Some(makespan_s), ..Record::default() };
        let mut drift = Drift::of(&[row(1.0), row(1.1)]);
        let warnings = |drift: &mut Drift, makespan_s| {
            let mut record = row(makespan_s);
            drift.watch(&mut record);
            record.warnings
        };
        assert_eq!(warnings(&mut drift, 2.0), "", "two rows say nothing yet");
        assert_eq!(warnings(&mut drift, 1.2), "");
        assert_eq!(warnings(&mut drift, 1.725), "drift(+50 %)");
        assert_eq!(warnings(&mut drift, 0.6), "drift(-50 %)");
    }
}
