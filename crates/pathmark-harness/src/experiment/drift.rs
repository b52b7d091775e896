//! Drift: detects that a machine becomes faster or slower while a sweep runs.
//!
//! Two times of each cell are watched: the makespan, which any disturbance can lengthen, and the processor time, which
//! waiting cannot lengthen. If the processor time grows, the processors were slower: on a virtual machine usually
//! because its host has put two of them on one core.

use crate::analysis::quantile::median;
use crate::measure::{Record, Warning};
use std::collections::HashMap;

/// Earlier rows that are needed to know the usual time of a cell.
const ENOUGH: usize = 3;
/// A row gets a warning if its makespan differs from the median so far by more than this share.
const SUSPICIOUS: f64 = 0.25;
/// The same for an increase of the processor time, which is steadier.
const SLOW: f64 = 0.15;

pub(super) struct Drift(HashMap<String, Times>);

#[derive(Default)]
struct Times {
    makespan_s: Vec<f64>,
    cpu_s: Vec<f64>,
}

/// The relative difference of a value from the median of earlier ones; `None` if there are fewer than [`ENOUGH`].
fn change(value: f64, before: &[f64]) -> Option<f64> {
    let usual = median(before).filter(|_| before.len() >= ENOUGH)?;
    Some(value / usual - 1.0)
}

fn percent(change: f64) -> i32 {
    (100.0 * change).round() as i32
}

impl Drift {
    /// Starts with the rows of an earlier part of the sweep.
    pub(super) fn of(done: &[Record]) -> Self {
        let mut drift = Self(HashMap::new());
        for record in done {
            drift.note(record);
        }
        drift
    }

    fn note(&mut self, record: &Record) {
        let times = self.0.entry(record.cell.clone()).or_default();
        times.makespan_s.extend(record.makespan_s);
        times.cpu_s.extend(record.cpu_s());
    }

    /// Adds a warning to a row whose times are far from those of its cell's earlier rows.
    pub(super) fn watch(&mut self, record: &mut Record) {
        if let Some(times) = self.0.get(&record.cell) {
            let drifted = record.makespan_s.and_then(|time| change(time, &times.makespan_s));
            if let Some(change) = drifted.filter(|change| change.abs() > SUSPICIOUS) {
                record.warn(&Warning::Drift { percent: percent(change) });
            }
            let slowed = record.cpu_s().and_then(|time| change(time, &times.cpu_s));
            if let Some(change) = slowed.filter(|change| *change > SLOW) {
                record.warn(&Warning::Slowed { percent: percent(change) });
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

    #[test]
    fn the_same_work_for_more_processor_time_is_marked() {
        let row = |cpu_s| Record {
            cell: "a".into(),
            makespan_s: Some(1.0),
            cpu_user_s: Some(cpu_s),
            cpu_system_s: Some(0.0),
            ..Record::default()
        };
        let mut drift = Drift::of(&[row(2.0), row(2.0), row(2.0)]);
        let mut slow = row(3.0);
        drift.watch(&mut slow);
        assert_eq!(slow.warnings, "slowed(+50 % CPU)");
        let mut fast = row(1.0);
        drift.watch(&mut fast);
        assert_eq!(fast.warnings, "");
    }
}
