//! The rows of an experiment, and groups of them by a key.

pub(crate) mod naming;
pub(crate) mod paired;
pub(crate) mod schedule;

use crate::analysis::quantile::median;
use crate::analysis::ranking::Turn;
use crate::experiment::turns;
use crate::measure::{ImageKey, Record, ScheduleKey};
use schedule::Schedule;
use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap};
use std::ops::Deref;
use std::slice::from_ref;

/// A row that did not fail, with the keys that identify it.
pub(crate) struct Row {
    record: Record,
    /// The row as it is in the file, if that differs from `record`.
    as_written: Option<Box<Record>>,
    pub(crate) image: ImageKey,
    pub(crate) schedule: Schedule,
    /// The process, and the pair, of which only runs that followed each other share the number.
    pub(crate) turn: Turn,
    /// The runs of its process in adjacent pairs, if it stands for several.
    runs: Vec<Self>,
}

impl Row {
    pub(crate) fn new(record: Record, as_written: Option<Box<Record>>, schedule: Schedule) -> Self {
        let turn = (record.repetition, record.pair);
        Self { image: record.image_key(), record, as_written, schedule, turn, runs: Vec::new() }
    }

    /// Its columns as they are in the file.
    pub(crate) fn as_written(&self) -> &Record {
        self.as_written.as_deref().unwrap_or(&self.record)
    }

    /// The key that rows are paired by: image, schedule, and repetition and pair, without the axes that `forget` clears.
    pub(crate) fn key(&self, forget: impl Fn(&mut ImageKey, &mut ScheduleKey)) -> (ImageKey, ScheduleKey, Turn) {
        let (mut image, mut schedule) = (self.image.clone(), self.schedule.key.clone());
        forget(&mut image, &mut schedule);
        (image, schedule, self.turn)
    }

    /// Its runs: itself, or all of its process.
    pub(crate) fn runs(&self) -> &[Self] {
        if self.runs.is_empty() { from_ref(self) } else { &self.runs }
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

/// One row for each process of a cell: its run of median time. Runs of a process share its memory layout, so they count as
/// one value wherever they are not compared within their pair.
pub(crate) fn by_process(mut rows: Vec<Row>) -> Vec<Row> {
    let turns = turns(&rows.iter().map(|row| &row.record).collect::<Vec<&Record>>());
    rows.iter_mut().zip(turns).for_each(|(row, turn)| row.turn = turn);
    let mut places: HashMap<(String, u32), usize> = HashMap::new();
    let mut processes: Vec<Vec<Row>> = Vec::new();
    for row in rows {
        if row.pair.is_none() {
            processes.push(vec![row]);
            continue;
        }
        match places.entry((row.cell.clone(), row.repetition)) {
            Entry::Occupied(place) => processes[*place.get()].push(row),
            Entry::Vacant(place) => {
                place.insert(processes.len());
                processes.push(vec![row]);
            }
        }
    }
    let typical = |runs: Vec<Row>| {
        let mut order: Vec<usize> = (0..runs.len()).collect();
        order.sort_by(|a, b| runs[*a].makespan_s.unwrap_or(0.0).total_cmp(&runs[*b].makespan_s.unwrap_or(0.0)));
        let own = &runs[order[order.len() / 2]];
        let row = Row::new(own.record.clone(), own.as_written.clone(), own.schedule.clone());
        let row = Row { turn: own.turn, ..row };
        if runs.len() == 1 && row.pair.is_none() { row } else { Row { runs, ..row } }
    };
    processes.into_iter().map(typical).collect()
}

/// Rows by a key, in the order of the key.
pub(crate) fn group<'a, K: Ord>(
    rows: impl IntoIterator<Item = &'a Row>,
    key: impl Fn(&'a Row) -> K,
) -> BTreeMap<K, Vec<&'a Row>> {
    gathered(rows.into_iter().map(|row| (key(row), row)))
}

/// Groups pairs by their first part, in its order.
pub(crate) fn gathered<K: Ord, V>(pairs: impl IntoIterator<Item = (K, V)>) -> BTreeMap<K, Vec<V>> {
    let mut groups: BTreeMap<K, Vec<V>> = BTreeMap::new();
    for (key, value) in pairs {
        groups.entry(key).or_default().push(value);
    }
    groups
}

/// The values of those rows that have one.
pub(crate) fn values(rows: impl IntoIterator<Item: AsRef<Row>>, value: impl Fn(&Row) -> Option<f64>) -> Vec<f64> {
    rows.into_iter().filter_map(|row| value(row.as_ref())).collect()
}

/// The median of a value over rows.
pub(crate) fn typical(rows: impl IntoIterator<Item: AsRef<Row>>, value: impl Fn(&Row) -> Option<f64>) -> Option<f64> {
    median(&values(rows, value))
}
