//! The rows of an experiment, and groups of them by a key.

use super::schedule::Schedule;
use crate::measure::{ImageKey, Record, ScheduleKey};
use std::collections::BTreeMap;
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

impl AsRef<Self> for Row {
    fn as_ref(&self) -> &Self {
        self
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
