//! The rows of an experiment and the operations of figures on them: groups by a key, pairs by shared properties,
//! ratios.

use super::schedule::Schedule;
use super::words::Told;
use crate::analysis::Estimate;
use crate::analysis::confidence_sequence::Stopping;
use crate::error::{InputError, Result};
use crate::measure::{ImageKey, Record, ScheduleKey};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Deref;

/// A row that did not fail, with the keys that identify it.
pub(super) struct Row {
    record: Record,
    /// The row as it is in the file, if that differs from `record`.
    as_written: Option<Box<Record>>,
    pub(super) image: ImageKey,
    pub(super) schedule: Schedule,
}

impl Row {
    pub(super) fn new(record: Record, as_written: Option<Box<Record>>, schedule: Schedule) -> Self {
        Self { image: record.image_key(), record, as_written, schedule }
    }

    /// Its columns as they are in the file.
    pub(super) fn as_written(&self) -> &Record {
        self.as_written.as_deref().unwrap_or(&self.record)
    }

    /// The key that rows are paired by: image, schedule and repetition, without the axes that `forget` clears.
    pub(super) fn key(&self, forget: impl Fn(&mut ImageKey, &mut ScheduleKey)) -> (ImageKey, ScheduleKey, u32) {
        let (mut image, mut schedule) = (self.image.clone(), self.schedule.key.clone());
        forget(&mut image, &mut schedule);
        (image, schedule, self.repetition)
    }
}

impl Deref for Row {
    type Target = Record;
    fn deref(&self) -> &Record {
        &self.record
    }
}

/// Rows by a key, in the order of the key.
pub(super) fn group<'a, K: Ord>(
    rows: impl IntoIterator<Item = &'a Row>,
    key: impl Fn(&'a Row) -> K,
) -> BTreeMap<K, Vec<&'a Row>> {
    gathered(rows.into_iter().map(|row| (key(row), row)))
}

/// Groups pairs by their first part, in its order.
pub(super) fn gathered<K: Ord, V>(pairs: impl IntoIterator<Item = (K, V)>) -> BTreeMap<K, Vec<V>> {
    let mut groups: BTreeMap<K, Vec<V>> = BTreeMap::new();
    for (key, value) in pairs {
        groups.entry(key).or_default().push(value);
    }
    groups
}

/// Rows by a key that identifies them. Two rows with one key are an error: one of them would be lost silently.
pub(super) fn unique<'a, K: Ord>(
    rows: impl IntoIterator<Item = &'a Row>,
    key: impl Fn(&'a Row) -> K,
) -> Result<BTreeMap<K, &'a Row>> {
    let mut found: BTreeMap<K, &Row> = BTreeMap::new();
    for row in rows {
        match found.entry(key(row)) {
            Entry::Vacant(place) => drop(place.insert(row)),
            Entry::Occupied(place) => {
                let problem = format!(
                    "a figure cannot tell it from {}, with which it shares what rows are compared by",
                    place.get().cell
                );
                return Err(InputError::new("cell", &row.cell, problem).into());
            }
        }
    }
    Ok(found)
}

/// Ratios of a value between rows of one kind and rows of another with the same key.
pub(super) fn ratios<'a, K: Ord>(
    above: impl IntoIterator<Item = &'a Row>,
    below: impl IntoIterator<Item = &'a Row>,
    key: impl Fn(&'a Row) -> K,
    value: impl Fn(&Row) -> Option<f64>,
) -> Result<Vec<f64>> {
    let above = unique(above, &key)?;
    let pairs = unique(below, &key)?.into_iter().filter_map(|(key, below)| Some((*above.get(&key)?, below)));
    Ok(pairs.filter_map(|(above, below)| Some(value(above)? / value(below)?)).collect())
}

/// How many times as long rows of one kind take as rows of another with the same key: the median of the ratios.
pub(super) fn time_ratio<'a, K: Ord>(
    above: impl IntoIterator<Item = &'a Row>,
    below: impl IntoIterator<Item = &'a Row>,
    key: impl Fn(&'a Row) -> K,
    stopping: Stopping,
) -> Result<Option<Estimate>> {
    let found = Told::median(&ratios(above, below, key, |row| row.makespan_s)?, stopping);
    Ok(found.and_then(|told| told.estimate()))
}
