//! Pairs of rows, and the ratios of their values. No other file of the report divides the value of one row by that of
//! another; `tests/library/pairing.rs` holds this rule.
//!
//! Both rows of a pair show one image in one repetition, apart from the axes that the comparison varies; where cells ran in
//! adjacent pairs, in one pair of one process. Machine drift therefore affects both equally, and no image size enters a
//! ratio. Adjacent pairs give an interval over processes ([`paired_ratio`]). Medians of several cells are compared only over
//! repetitions that these cells share; ratios of several groups of pairs share none ([`ratios_of_groups`]).

use crate::analysis::adjacent_pairs::paired_ratio;
use crate::analysis::confidence_sequence::Stopping;
use crate::analysis::quantile::median;
use crate::analysis::ranking::Turn;
use crate::analysis::{Estimate, Interval};
use crate::error::{InputError, Result};
use crate::estimated::{Estimated, LEVEL};
use crate::measure::{ImageKey, ScheduleKey};
use crate::rows::{Row, gathered};
use crate::words::with_level;
use std::cmp::Ordering;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

/// The properties that the rows of a pair share: image and schedule, without the axes that the comparison varies, and
/// repetition and pair.
type Shared = (ImageKey, ScheduleKey, Turn);

/// Clears the axes in which the rows of a pair may differ.
pub(crate) type Forget = fn(&mut ImageKey, &mut ScheduleKey);

/// Forgets the whole schedule: the rows of a pair render the same image in any way.
pub(crate) fn any_schedule(_: &mut ImageKey, schedule: &mut ScheduleKey) {
    *schedule = ScheduleKey::default();
}

/// Items by a key that identifies them. `of_two` is the error about two items with one key: one of them would be lost
/// silently.
pub(crate) fn identified<K: Ord, T: Copy>(
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

/// Ratios of a value between items of two lists that share a key, each with the item of the first list. The key identifies the
/// items of the second list.
pub(crate) fn ratios_by<K: Ord, T: Copy>(
    above: impl IntoIterator<Item = (K, T)>,
    below: impl IntoIterator<Item = (K, T)>,
    of_two: impl Fn(T, T) -> InputError,
    value: impl Fn(T) -> Option<f64>,
) -> Result<Vec<(T, f64)>> {
    let below = identified(below, of_two)?;
    let ratio = |(key, item): (K, T)| Some((item, value(item)? / value(*below.get(&key)?)?));
    Ok(above.into_iter().filter_map(ratio).collect())
}

/// Rows to compare others with, by what a pair shares.
pub(crate) struct Partners<'a> {
    forget: Forget,
    rows: BTreeMap<Shared, &'a Row>,
}

impl<'a> Partners<'a> {
    /// Rows that the key identifies.
    pub(crate) fn of(rows: impl IntoIterator<Item = &'a Row>, forget: Forget) -> Result<Self> {
        let rows = identified(runs(rows).map(|row| (row.key(forget), row)), alike)?;
        Ok(Self { forget, rows })
    }

    /// Of the rows with one key, the fastest.
    pub(crate) fn fastest(rows: impl IntoIterator<Item = &'a Row>, forget: Forget) -> Self {
        let mut found: BTreeMap<Shared, &Row> = BTreeMap::new();
        for row in runs(rows).filter(|row| row.makespan_s.is_some()) {
            let best = found.entry(row.key(forget)).or_insert(row);
            if row.makespan_s < best.makespan_s {
                *best = row;
            }
        }
        Self { forget, rows: found }
    }

    /// Rows with their partners, in the order of the rows; leaves out rows without one.
    pub(crate) fn pairs<'b>(&self, rows: impl IntoIterator<Item = &'b Row>) -> Pairs<'b>
    where
        'a: 'b,
    {
        Pairs(runs(rows).filter_map(|row| Some((row, *self.rows.get(&row.key(self.forget))?))).collect())
    }
}

/// The runs of rows, each of its own pair.
fn runs<'a>(rows: impl IntoIterator<Item = &'a Row>) -> impl Iterator<Item = &'a Row> {
    rows.into_iter().flat_map(Row::runs)
}

/// The values of each repetition of an image and a schedule: several, if its process ran pairs.
fn processes<'a>(values: impl IntoIterator<Item = (&'a Shared, &'a f64)>) -> BTreeMap<Shared, Vec<f64>> {
    let of_process = |((image, schedule, (repetition, _)), value): (&Shared, &f64)| {
        ((image.clone(), schedule.clone(), (*repetition, None)), *value)
    };
    gathered(values.into_iter().map(of_process))
}

/// The estimate from the values of a cell: over processes if they are of adjacent pairs, and else their typical value.
fn estimated<'a>(values: impl IntoIterator<Item = (&'a Shared, &'a f64)>, stopping: Stopping) -> Option<Estimated> {
    let values: Vec<(&Shared, &f64)> = values.into_iter().collect();
    let is_in_pairs = values.iter().any(|((_, _, (_, pair)), _)| pair.is_some());
    let own: Vec<Vec<f64>> = processes(values).into_values().collect();
    if let Some(found) = paired_ratio(&own, LEVEL).filter(|_| is_in_pairs && stopping == Stopping::Fixed) {
        return Some(Estimated { count: Some(found.processes), ..found.ratio.into() });
    }
    Estimated::typical(&own.iter().filter_map(|own| median(own)).collect::<Vec<f64>>(), stopping)
}

fn alike(row: &Row, other: &Row) -> InputError {
    let problem =
        format!("a figure cannot tell it from {}, with which it shares what rows are compared by", other.cell);
    InputError::new("cell", &row.cell, problem)
}

/// Rows, each with its partner.
pub(crate) struct Pairs<'a>(Vec<(&'a Row, &'a Row)>);

impl<'a> Pairs<'a> {
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&'a Row, &'a Row)> + '_ {
        self.0.iter().copied()
    }

    /// A value of each row and its partner.
    pub(crate) fn values(&self, value: impl Fn(&Row, &Row) -> Option<f64>) -> Repeats {
        let values = self.iter().filter_map(|(own, partner)| Some((own.key(|_, _| ()), value(own, partner)?)));
        Repeats(values.collect())
    }

    /// The partner's value over the row's own.
    pub(crate) fn gains(&self, value: impl Fn(&Row) -> Option<f64>) -> Repeats {
        self.values(|own, partner| Some(value(partner)? / value(own)?))
    }

    /// The row's value over its partner's.
    pub(crate) fn costs(&self, value: impl Fn(&Row) -> Option<f64>) -> Repeats {
        self.values(|own, partner| Some(value(own)? / value(partner)?))
    }
}

/// Values of a cell, or ratios of two, by image and repetition.
#[derive(Debug, Clone, Default)]
pub(crate) struct Repeats(BTreeMap<Shared, f64>);

impl Repeats {
    /// A value of each row. Rows that share what the comparison keeps are an error.
    pub(crate) fn of<'a>(
        rows: impl IntoIterator<Item = &'a Row>,
        forget: Forget,
        value: impl Fn(&Row) -> Option<f64>,
    ) -> Result<Self> {
        let rows = Partners::of(rows, forget)?.rows.into_iter();
        Ok(Self(rows.filter_map(|(key, row)| Some((key, value(row)?))).collect()))
    }

    /// A value of each row, by its own image, schedule and repetition.
    pub(crate) fn of_rows<'a>(rows: impl IntoIterator<Item = &'a Row>, value: impl Fn(&Row) -> Option<f64>) -> Self {
        Self(runs(rows).filter_map(|row| Some((row.key(|_, _| ()), value(row)?))).collect())
    }

    /// The mean value of the rows that share a key.
    pub(crate) fn means<'a>(
        rows: impl IntoIterator<Item = &'a Row>,
        forget: Forget,
        value: impl Fn(&Row) -> Option<f64>,
    ) -> Self {
        let mut sums: BTreeMap<Shared, (f64, f64)> = BTreeMap::new();
        for (key, value) in runs(rows).filter_map(|row| Some((row.key(forget), value(row)?))) {
            let (sum, count) = sums.entry(key).or_default();
            (*sum, *count) = (*sum + value, *count + 1.0);
        }
        Self(sums.into_iter().map(|(key, (sum, count))| (key, sum / count)).collect())
    }

    /// A value of each image, which all schedules and repetitions share.
    pub(crate) fn of_images<'a>(
        rows: impl IntoIterator<Item = &'a Row>,
        forget: fn(&mut ImageKey),
        value: impl Fn(&Row) -> Option<f64>,
    ) -> Self {
        let place = |row: &Row| {
            let mut image = row.image.clone();
            forget(&mut image);
            (image, ScheduleKey::default(), (0, None))
        };
        Self(rows.into_iter().filter_map(|row| Some((place(row), value(row)?))).collect())
    }

    /// The ratios of two values with the same key.
    pub(crate) fn over(&self, below: &Self) -> Self {
        self.with(below, |above, below| above / below)
    }

    /// The differences of two values with the same key.
    pub(crate) fn minus(&self, other: &Self) -> Self {
        self.with(other, |own, other| own - other)
    }

    fn with(&self, other: &Self, value: impl Fn(f64, f64) -> f64) -> Self {
        let pairs = self.0.iter().filter_map(|(key, own)| Some((key.clone(), value(*own, *other.0.get(key)?))));
        Self(pairs.collect())
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn is_in_pairs(&self) -> bool {
        self.0.keys().all(|(_, _, (_, pair))| pair.is_some())
    }

    /// A value of each repetition: the median of its pairs, if it has several.
    pub(crate) fn values(&self) -> Vec<f64> {
        processes(&self.0).values().filter_map(|own| median(own)).collect()
    }

    /// The typical value over all repetitions of this cell: see [`Estimated::typical`].
    pub(crate) fn median(&self, stopping: Stopping) -> Option<Estimated> {
        estimated(&self.0, stopping)
    }

    /// The images, without their seeds: values of other images are not compared with these.
    fn images(&self) -> BTreeSet<ImageKey> {
        self.0.keys().map(|(image, ..)| image.without_seed()).collect()
    }
}

/// Ratios of a value between rows of one kind and rows of another that agree in what `forget` leaves.
pub(crate) fn ratios<'a>(
    above: impl IntoIterator<Item = &'a Row>,
    below: impl IntoIterator<Item = &'a Row>,
    forget: Forget,
    value: impl Fn(&Row) -> Option<f64>,
) -> Result<Repeats> {
    Ok(Repeats::of(above, forget, &value)?.over(&Repeats::of(below, forget, &value)?))
}

/// How many times as long rows of one kind take as rows of another: the typical ratio.
pub(crate) fn time_ratio<'a>(
    above: impl IntoIterator<Item = &'a Row>,
    below: impl IntoIterator<Item = &'a Row>,
    forget: Forget,
    stopping: Stopping,
) -> Result<Option<Ratio>> {
    Ok(ratios(above, below, forget, |row| row.makespan_s)?.median(stopping).and_then(Ratio::of))
}

/// How many times as long the first rows of each cell take as the second, over repetitions that the cells share.
pub(crate) fn time_ratios<'a, T>(
    cells: impl IntoIterator<Item = (T, &'a [&'a Row], &'a [&'a Row])>,
    forget: Forget,
    stopping: Stopping,
) -> Result<Vec<(T, Ratio)>> {
    let ratio = |(thing, above, below): (T, &[&'a Row], &[&'a Row])| {
        let (above, below) = (above.iter().copied(), below.iter().copied());
        Ok((thing, ratios(above, below, forget, |row| row.makespan_s)?))
    };
    let cells = cells.into_iter().map(ratio).collect::<Result<Vec<_>>>()?;
    Ok(estimates(cells, stopping))
}

/// A median ratio with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ratio {
    pub(crate) value: f64,
    pub(crate) interval: Interval,
    /// The number of ratios.
    pub(crate) count: Option<usize>,
    /// Whether it lacks repetitions that the ratios beside it have. Such a ratio is drawn hollow and never ranked.
    pub(crate) is_partial: bool,
}

impl Ratio {
    /// `None` without an interval.
    pub(crate) fn of(told: Estimated) -> Option<Self> {
        let Estimated { value, interval, count, is_partial } = told;
        Some(Self { value, interval: interval?, count, is_partial })
    }

    pub(crate) fn estimate(&self) -> Estimate {
        Estimate { value: self.value, interval: self.interval }
    }

    /// The ratio, its interval and the interval's confidence.
    pub(crate) fn in_words(&self, digits: usize) -> String {
        format!("{:.digits$}, {}", self.value, with_level(&self.interval, digits))
    }

    /// The order from the smallest ratio to the largest; partial ones follow all others, because they are not ranked.
    pub(crate) fn rising(&self, other: &Self) -> Ordering {
        self.is_partial.cmp(&other.is_partial).then(self.value.total_cmp(&other.value))
    }

    /// The order from the largest ratio to the smallest, and then the partial ones.
    pub(crate) fn falling(&self, other: &Self) -> Ordering {
        self.is_partial.cmp(&other.is_partial).then(other.value.total_cmp(&self.value))
    }
}

impl From<Ratio> for Estimated {
    fn from(Ratio { value, interval, count, is_partial }: Ratio) -> Self {
        Self { value, interval: Some(interval), count, is_partial }
    }
}

/// The typical values of several cells: medians, or means of few values ([`Estimated::typical`]). Cells of the same images are compared over repetitions that they share: either those
/// of one cell, or those that all cells of the most repetitions have. Of these choices the one counts that gives the
/// most values in cells without a gap. A cell that lacks one of these repetitions is partial.
pub(crate) fn medians<T>(cells: impl IntoIterator<Item = (T, Repeats)>, stopping: Stopping) -> Vec<(T, Estimated)> {
    let cells: Vec<(T, Repeats)> = cells.into_iter().collect();
    let alone: Vec<usize> = (0..cells.len()).collect();
    compared(cells, &alone, stopping)
}

/// The medians of the points of several lines. The points of a line are compared as cells of the same images are, even
/// if each has an image of its own; repetitions of two images then correspond if they have one seed and one number.
pub(crate) fn along<T, L: Ord>(
    cells: impl IntoIterator<Item = (T, Repeats)>,
    line: impl Fn(&T) -> L,
    stopping: Stopping,
) -> Vec<(T, Estimated)> {
    let cells: Vec<(T, Repeats)> = cells.into_iter().collect();
    let lines: Vec<L> = cells.iter().map(|(thing, _)| line(thing)).collect();
    compared(cells, &lines, stopping)
}

/// The medians that have an interval.
fn estimates<T>(cells: impl IntoIterator<Item = (T, Repeats)>, stopping: Stopping) -> Vec<(T, Ratio)> {
    with_intervals(medians(cells, stopping))
}

/// The ratios of groups of cells: in adjacent pairs each over all its processes, because two groups share none; otherwise as
/// [`medians`].
pub(crate) fn ratios_of_groups<T>(
    cells: impl IntoIterator<Item = (T, Repeats)>,
    stopping: Stopping,
) -> Vec<(T, Ratio)> {
    let cells: Vec<(T, Repeats)> = cells.into_iter().collect();
    if !cells.iter().all(|(_, repeats)| repeats.is_in_pairs()) {
        return estimates(cells, stopping);
    }
    let ratio = |(thing, repeats): (T, Repeats)| Some((thing, Ratio::of(repeats.median(stopping)?)?));
    cells.into_iter().filter_map(ratio).collect()
}

/// Those with an interval.
pub(crate) fn with_intervals<T>(told: Vec<(T, Estimated)>) -> Vec<(T, Ratio)> {
    told.into_iter().filter_map(|(thing, told)| Some((thing, Ratio::of(told)?))).collect()
}

/// A repetition of an image, or of all images with this seed.
type Place = (ImageKey, u32);

fn compared<T, L: Ord>(cells: Vec<(T, Repeats)>, lines: &[L], stopping: Stopping) -> Vec<(T, Estimated)> {
    let images: Vec<BTreeSet<ImageKey>> = cells.iter().map(|(_, repeats)| repeats.images()).collect();
    let mut found: Vec<Option<Estimated>> = vec![None; cells.len()];
    for indices in peers(&images, lines) {
        let is_of_one = indices.iter().all(|index| images[*index] == images[indices[0]]);
        let place = |(image, _, (repetition, _)): &Shared| {
            let of_any = || ImageKey { seed: image.seed, ..ImageKey::default() };
            (if is_of_one { image.clone() } else { of_any() }, *repetition)
        };
        let places = indices.iter().map(|index| {
            let mut counts: BTreeMap<Place, usize> = BTreeMap::new();
            for key in processes(&cells[*index].1.0).keys() {
                *counts.entry(place(key)).or_default() += 1;
            }
            // A round counts if each image of the cell has it.
            let whole = if is_of_one { 1 } else { counts.values().copied().max().unwrap_or(0) };
            counts.into_iter().filter(|(_, count)| *count >= whole).map(|(place, _)| place).collect()
        });
        let places: Vec<BTreeSet<Place>> = places.collect();
        let block = common(&places);
        for (index, own) in indices.iter().zip(&places) {
            let is_partial = !block.is_subset(own);
            let values = cells[*index].1.0.iter().filter(|(key, _)| is_partial || block.contains(&place(key)));
            let told = estimated(values, stopping);
            found[*index] = told.map(|told| Estimated { is_partial, ..told });
        }
    }
    cells.into_iter().zip(found).filter_map(|((thing, _), told)| Some((thing, told?))).collect()
}

/// Which cells are compared with one another: those of the same images or the same line, directly or through others.
fn peers<L: Ord>(images: &[BTreeSet<ImageKey>], lines: &[L]) -> Vec<Vec<usize>> {
    let (mut by_images, mut by_line) = (BTreeMap::new(), BTreeMap::new());
    for index in 0..images.len() {
        by_images.entry(&images[index]).or_insert_with(Vec::new).push(index);
        by_line.entry(&lines[index]).or_insert_with(Vec::new).push(index);
    }
    let mut is_taken = vec![false; images.len()];
    let mut all = Vec::new();
    for first in 0..images.len() {
        let (mut own, mut next) = (Vec::new(), vec![first]);
        while let Some(index) = next.pop() {
            if !std::mem::replace(&mut is_taken[index], true) {
                own.push(index);
                // Taking a group out visits each group once.
                next.extend(by_images.remove(&images[index]).into_iter().flatten());
                next.extend(by_line.remove(&lines[index]).into_iter().flatten());
            }
        }
        if !own.is_empty() {
            own.sort_unstable();
            all.push(own);
        }
    }
    all
}

/// The repetitions over which cells are compared.
fn common(places: &[BTreeSet<Place>]) -> BTreeSet<Place> {
    let mut kinds: BTreeMap<&BTreeSet<Place>, usize> = BTreeMap::new();
    for own in places {
        *kinds.entry(own).or_default() += 1;
    }
    // Only cells that have a place of the block can have all of them.
    let mut having: BTreeMap<&Place, Vec<_>> = BTreeMap::new();
    for (own, count) in &kinds {
        own.iter().for_each(|place| having.entry(place).or_default().push((*own, *count)));
    }
    let size = |block: &BTreeSet<Place>| {
        let others = block.iter().filter_map(|place| having.get(place)).min_by_key(|others| others.len());
        let whole = others.into_iter().flatten().filter(|(own, _)| block.is_subset(own));
        (whole.map(|(_, count)| count).sum::<usize>() * block.len(), block.len())
    };
    let mut choices: Vec<BTreeSet<Place>> = kinds.keys().map(|own| (*own).clone()).collect();
    choices.sort_by_key(|own| std::cmp::Reverse(own.len()));
    for at in 1..choices.len() {
        // The cells of the most repetitions may each lack another one, as after a failure.
        let before = choices.last().filter(|_| at > 1).unwrap_or(&choices[0]);
        choices.push(before.intersection(&choices[at]).cloned().collect());
    }
    choices.into_iter().max_by_key(size).unwrap_or_default()
}

/// The values of cells in the seeds and repetitions that all of them have, for one fit through all of them.
pub(crate) fn in_common<T>(cells: Vec<(T, Repeats)>) -> Vec<(T, Vec<f64>)> {
    let round = |(image, _, (repetition, _)): &Shared| (image.seed, *repetition);
    let rounds = cells.iter().map(|(_, repeats)| repeats.0.keys().map(round).collect::<BTreeSet<_>>());
    let common = rounds.reduce(|all, own| all.intersection(&own).copied().collect()).unwrap_or_default();
    let values = |repeats: Repeats| {
        let own = repeats.0.iter().filter(|(key, _)| common.contains(&round(key)));
        processes(own).values().filter_map(|own| median(own)).collect()
    };
    cells.into_iter().map(|(thing, repeats)| (thing, values(repeats))).collect()
}
