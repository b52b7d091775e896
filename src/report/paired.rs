//! Pairs of rows, and the ratios of their values. No other file of the report divides the value of one row by that of
//! another; `tests/library/pairing.rs` holds this rule.
//!
//! Both rows of a pair show one image in one repetition, apart from the axes that the comparison varies. Machine drift
//! therefore affects both equally, and no image size enters a ratio. Medians of several cells are compared only over
//! repetitions that these cells share.

use super::rows::Row;
use super::words::Told;
use crate::analysis::confidence_sequence::Stopping;
use crate::analysis::{Estimate, Interval};
use crate::error::{InputError, Result};
use crate::measure::{ImageKey, ScheduleKey};
use std::cmp::Ordering;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

/// The properties that the rows of a pair share: image and schedule, without the axes that the comparison varies, and
/// the repetition.
type Shared = (ImageKey, ScheduleKey, u32);

/// Clears the axes in which the rows of a pair may differ.
pub(super) type Forget = fn(&mut ImageKey, &mut ScheduleKey);

/// Forgets the whole schedule: the rows of a pair render the same image in any way.
pub(super) fn any_schedule(_: &mut ImageKey, schedule: &mut ScheduleKey) {
    *schedule = ScheduleKey::default();
}

/// Items by a key that identifies them. `of_two` is the error about two items with one key: one of them would be lost
/// silently.
pub(super) fn identified<K: Ord, T: Copy>(
    items: impl IntoIterator<Item = (K, T)>,
    of_two: impl Fn(T, T) -> InputError,
) -> Result<BTreeMap<K, T>> {
    let mut found = BTreeMap::new();
    for (key, item) in items {
        match found.entry(key) {
            Entry::Vacant(place) => drop(place.insert(item)),
            Entry::Occupied(place) => return Err(of_two(item, *place.get()).into()),
        }
    }
    Ok(found)
}

/// Ratios of a value between items of two lists that share a key. The key identifies the items of the second list.
pub(super) fn ratios_by<K: Ord, T: Copy>(
    above: impl IntoIterator<Item = (K, T)>,
    below: impl IntoIterator<Item = (K, T)>,
    of_two: impl Fn(T, T) -> InputError,
    value: impl Fn(T) -> Option<f64>,
) -> Result<Vec<f64>> {
    let below = identified(below, of_two)?;
    let ratio = |(key, item): (K, T)| Some(value(item)? / value(*below.get(&key)?)?);
    Ok(above.into_iter().filter_map(ratio).collect())
}

/// Rows to compare others with, by what a pair shares.
pub(super) struct Partners<'a> {
    forget: Forget,
    rows: BTreeMap<Shared, &'a Row>,
}

impl<'a> Partners<'a> {
    /// Rows that the key identifies.
    pub(super) fn of(rows: impl IntoIterator<Item = &'a Row>, forget: Forget) -> Result<Self> {
        let rows = identified(rows.into_iter().map(|row| (row.key(forget), row)), alike)?;
        Ok(Self { forget, rows })
    }

    /// Of the rows with one key, the fastest.
    pub(super) fn fastest(rows: impl IntoIterator<Item = &'a Row>, forget: Forget) -> Self {
        let mut found: BTreeMap<Shared, &Row> = BTreeMap::new();
        for row in rows.into_iter().filter(|row| row.makespan_s.is_some()) {
            let best = found.entry(row.key(forget)).or_insert(row);
            if row.makespan_s < best.makespan_s {
                *best = row;
            }
        }
        Self { forget, rows: found }
    }

    /// Rows with their partners, in the order of the rows; leaves out rows without one.
    pub(super) fn pairs<'b>(&self, rows: impl IntoIterator<Item = &'b Row>) -> Pairs<'b>
    where
        'a: 'b,
    {
        Pairs(rows.into_iter().filter_map(|row| Some((row, *self.rows.get(&row.key(self.forget))?))).collect())
    }
}

fn alike(row: &Row, other: &Row) -> InputError {
    let problem =
        format!("a figure cannot tell it from {}, with which it shares what rows are compared by", other.cell);
    InputError::new("cell", &row.cell, problem)
}

/// Rows, each with its partner.
pub(super) struct Pairs<'a>(Vec<(&'a Row, &'a Row)>);

impl<'a> Pairs<'a> {
    pub(super) fn iter(&self) -> impl Iterator<Item = (&'a Row, &'a Row)> + '_ {
        self.0.iter().copied()
    }

    /// A value of each row and its partner.
    pub(super) fn values(&self, value: impl Fn(&Row, &Row) -> Option<f64>) -> Repeats {
        let values = self.iter().filter_map(|(own, partner)| Some((own.key(|_, _| ()), value(own, partner)?)));
        Repeats(values.collect())
    }

    /// The partner's value over the row's own.
    pub(super) fn gains(&self, value: impl Fn(&Row) -> Option<f64>) -> Repeats {
        self.values(|own, partner| Some(value(partner)? / value(own)?))
    }

    /// The row's value over its partner's.
    pub(super) fn costs(&self, value: impl Fn(&Row) -> Option<f64>) -> Repeats {
        self.values(|own, partner| Some(value(own)? / value(partner)?))
    }
}

/// Values of a cell, or ratios of two, by image and repetition.
#[derive(Debug, Clone, Default)]
pub(super) struct Repeats(BTreeMap<Shared, f64>);

impl Repeats {
    /// A value of each row. Rows that share what the comparison keeps are an error.
    pub(super) fn of<'a>(
        rows: impl IntoIterator<Item = &'a Row>,
        forget: Forget,
        value: impl Fn(&Row) -> Option<f64>,
    ) -> Result<Self> {
        let rows = Partners::of(rows, forget)?.rows.into_iter();
        Ok(Self(rows.filter_map(|(key, row)| Some((key, value(row)?))).collect()))
    }

    /// A value of each row, by its own image, schedule and repetition.
    pub(super) fn of_rows<'a>(rows: impl IntoIterator<Item = &'a Row>, value: impl Fn(&Row) -> Option<f64>) -> Self {
        Self(rows.into_iter().filter_map(|row| Some((row.key(|_, _| ()), value(row)?))).collect())
    }

    /// The mean value of the rows that share a key.
    pub(super) fn means<'a>(
        rows: impl IntoIterator<Item = &'a Row>,
        forget: Forget,
        value: impl Fn(&Row) -> Option<f64>,
    ) -> Self {
        let mut sums: BTreeMap<Shared, (f64, f64)> = BTreeMap::new();
        for (key, value) in rows.into_iter().filter_map(|row| Some((row.key(forget), value(row)?))) {
            let (sum, count) = sums.entry(key).or_default();
            (*sum, *count) = (*sum + value, *count + 1.0);
        }
        Self(sums.into_iter().map(|(key, (sum, count))| (key, sum / count)).collect())
    }

    /// A value of each image, which all schedules and repetitions share.
    pub(super) fn of_images<'a>(
        rows: impl IntoIterator<Item = &'a Row>,
        forget: fn(&mut ImageKey),
        value: impl Fn(&Row) -> Option<f64>,
    ) -> Self {
        let place = |row: &Row| {
            let mut image = row.image.clone();
            forget(&mut image);
            (image, ScheduleKey::default(), 0)
        };
        Self(rows.into_iter().filter_map(|row| Some((place(row), value(row)?))).collect())
    }

    /// The ratios of two values with the same key.
    pub(super) fn over(&self, below: &Self) -> Self {
        self.with(below, |above, below| above / below)
    }

    /// The differences of two values with the same key.
    pub(super) fn minus(&self, other: &Self) -> Self {
        self.with(other, |own, other| own - other)
    }

    fn with(&self, other: &Self, value: impl Fn(f64, f64) -> f64) -> Self {
        let pairs = self.0.iter().filter_map(|(key, own)| Some((key.clone(), value(*own, *other.0.get(key)?))));
        Self(pairs.collect())
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn values(&self) -> Vec<f64> {
        self.0.values().copied().collect()
    }

    /// The median over all repetitions of this cell.
    pub(super) fn median(&self, stopping: Stopping) -> Option<Told> {
        Told::median(&self.values(), stopping)
    }

    /// The images, without their seeds: values of other images are not compared with these.
    fn images(&self) -> BTreeSet<ImageKey> {
        self.0.keys().map(|(image, ..)| image.without_seed()).collect()
    }

    fn places(&self) -> BTreeSet<(&ImageKey, u32)> {
        self.0.keys().map(|(image, _, repetition)| (image, *repetition)).collect()
    }
}

/// Ratios of a value between rows of one kind and rows of another that agree in what `forget` leaves.
pub(super) fn ratios<'a>(
    above: impl IntoIterator<Item = &'a Row>,
    below: impl IntoIterator<Item = &'a Row>,
    forget: Forget,
    value: impl Fn(&Row) -> Option<f64>,
) -> Result<Repeats> {
    Ok(Repeats::of(above, forget, &value)?.over(&Repeats::of(below, forget, &value)?))
}

/// How many times as long rows of one kind take as rows of another: the median of the ratios.
pub(super) fn time_ratio<'a>(
    above: impl IntoIterator<Item = &'a Row>,
    below: impl IntoIterator<Item = &'a Row>,
    forget: Forget,
    stopping: Stopping,
) -> Result<Option<Ratio>> {
    Ok(ratios(above, below, forget, |row| row.makespan_s)?.median(stopping).and_then(Ratio::of))
}

/// A median ratio with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ratio {
    pub(super) value: f64,
    pub(super) interval: Interval,
    /// The number of ratios.
    pub(super) count: Option<usize>,
    /// Whether it lacks repetitions that the ratios beside it have. Such a ratio is drawn hollow and never ranked.
    pub(super) is_partial: bool,
}

impl Ratio {
    /// `None` without an interval.
    pub(super) fn of(told: Told) -> Option<Self> {
        let Told { value, interval, count, is_partial } = told;
        Some(Self { value, interval: interval?, count, is_partial })
    }

    pub(super) fn estimate(&self) -> Estimate {
        Estimate { value: self.value, interval: self.interval }
    }

    /// The order from the smallest ratio to the largest; partial ones follow all others, because they are not ranked.
    pub(super) fn rising(&self, other: &Self) -> Ordering {
        self.is_partial.cmp(&other.is_partial).then(self.value.total_cmp(&other.value))
    }

    /// The order from the largest ratio to the smallest, and then the partial ones.
    pub(super) fn falling(&self, other: &Self) -> Ordering {
        self.is_partial.cmp(&other.is_partial).then(other.value.total_cmp(&self.value))
    }
}

impl From<Ratio> for Told {
    fn from(Ratio { value, interval, count, is_partial }: Ratio) -> Self {
        Self { value, interval: Some(interval), count, is_partial }
    }
}

/// The medians of several cells. Cells of the same images are compared over repetitions that they share: either those
/// of one cell, or those that all cells of the most repetitions have. Of these choices the one counts that gives the
/// most values in cells without a gap. A cell that lacks one of these repetitions is partial.
pub(super) fn medians<T>(cells: impl IntoIterator<Item = (T, Repeats)>, stopping: Stopping) -> Vec<(T, Told)> {
    let cells: Vec<(T, Repeats)> = cells.into_iter().collect();
    let mut peers: BTreeMap<BTreeSet<ImageKey>, Vec<usize>> = BTreeMap::new();
    for (index, (_, repeats)) in cells.iter().enumerate() {
        peers.entry(repeats.images()).or_default().push(index);
    }
    let mut found: Vec<Option<Told>> = vec![None; cells.len()];
    for indices in peers.into_values() {
        let places: Vec<_> = indices.iter().map(|index| cells[*index].1.places()).collect();
        let mut kinds: BTreeMap<&BTreeSet<_>, usize> = BTreeMap::new();
        for own in &places {
            *kinds.entry(own).or_default() += 1;
        }
        // Only cells that have a place of the block can have all of them.
        let mut having: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for (own, count) in &kinds {
            own.iter().for_each(|place| having.entry(place).or_default().push((*own, *count)));
        }
        let size = |block: &BTreeSet<_>| {
            let others = block.iter().filter_map(|place| having.get(place)).min_by_key(|others| others.len());
            let whole = others.into_iter().flatten().filter(|(own, _)| block.is_subset(own));
            (whole.map(|(_, count)| count).sum::<usize>() * block.len(), block.len())
        };
        let mut choices: Vec<BTreeSet<_>> = kinds.keys().map(|own| (*own).clone()).collect();
        choices.sort_by_key(|own| std::cmp::Reverse(own.len()));
        for at in 1..choices.len() {
            // The cells of the most repetitions may each lack another one, as after a failure.
            let before = choices.last().filter(|_| at > 1).unwrap_or(&choices[0]);
            choices.push(before.intersection(&choices[at]).copied().collect());
        }
        let Some(block) = choices.iter().max_by_key(|block| size(block)) else { continue };
        for (index, own) in indices.iter().zip(&places) {
            let is_partial = !block.is_subset(own);
            let is_meant = |(image, _, repetition): &Shared| is_partial || block.contains(&(image, *repetition));
            let values = cells[*index].1.0.iter().filter(|(key, _)| is_meant(key)).map(|(_, value)| *value);
            let told = Told::median(&values.collect::<Vec<f64>>(), stopping);
            found[*index] = told.map(|told| Told { is_partial, ..told });
        }
    }
    cells.into_iter().zip(found).filter_map(|((thing, _), told)| Some((thing, told?))).collect()
}

/// The medians that have an interval.
pub(super) fn estimates<T>(cells: impl IntoIterator<Item = (T, Repeats)>, stopping: Stopping) -> Vec<(T, Ratio)> {
    medians(cells, stopping).into_iter().filter_map(|(thing, told)| Some((thing, Ratio::of(told)?))).collect()
}

/// The values of cells in the seeds and repetitions that all of them have, for one fit through all of them.
pub(super) fn in_common<T>(cells: Vec<(T, Repeats)>) -> Vec<(T, Vec<f64>)> {
    let round = |(image, _, repetition): &Shared| (image.seed, *repetition);
    let rounds = cells.iter().map(|(_, repeats)| repeats.0.keys().map(round).collect::<BTreeSet<_>>());
    let common = rounds.reduce(|all, own| all.intersection(&own).copied().collect()).unwrap_or_default();
    let values = |repeats: Repeats| {
        repeats.0.into_iter().filter(|(key, _)| common.contains(&round(key))).map(|(_, value)| value).collect()
    };
    cells.into_iter().map(|(thing, repeats)| (thing, values(repeats))).collect()
}
