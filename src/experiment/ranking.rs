//! Rankings of the schedules of an image by speed, from the rows of an experiment.
//!
//! A repetition of an image is a block: its rows were measured shortly after each other, so machine drift affects all
//! of them.

use super::Cell;
use super::definition::Definition;
use super::diff::level_of;
use super::profile::Profile;
use super::records_file::read_records;
use super::run_file::{MACHINE, read_run_file};
use super::until::MOST_REPETITIONS;
use crate::analysis::Interval;
use crate::analysis::confidence_sequence::{Stopping, median_sequence};
use crate::analysis::quantile::median;
use crate::analysis::ranking::{groups, least_blocks, may_be_least, order_so_far, told_apart};
use crate::error::{InputError, Result};
use crate::input::read_text;
use crate::lab::Lab;
use crate::measure::{Doubts, ImageKey, Record};
use serde::Serialize;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

/// The probability that any reported order is wrong.
pub(super) const MISS: f64 = 0.05;

/// A schedule's place among those of its image.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Place {
    /// The schedule: the part of its cells' names after the image.
    pub schedule: String,
    /// Median seconds.
    pub median_s: f64,
    /// Time relative to the first schedule: the median of the ratios within a repetition.
    pub ratio: f64,
    /// The interval of the ratio; the intervals of all places hold together with 95 % confidence. `None` for the first
    /// place, and with too few repetitions.
    pub interval: Option<Interval>,
    /// Repetitions.
    pub repetitions: usize,
    /// Numbers of the groups that it belongs to, from 0. Two schedules that share a group cannot be told apart.
    pub groups: Vec<usize>,
}

/// The schedules of an image, the fastest first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImageRanking {
    /// The image, in one word.
    pub image: String,
    /// The schedules.
    pub places: Vec<Place>,
    /// The schedules that are not known to be slower than another: with 95 % confidence, for all images together, the
    /// fastest is among them. Schedules whose matrix limits their repetitions are not compared.
    pub fastest: Vec<String>,
    /// How many schedules were compared for `fastest`.
    pub compared: usize,
}

/// The schedules of all images of an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranking {
    /// Image by image.
    pub images: Vec<ImageRanking>,
    /// The fewest repetitions that can tell any two schedules apart.
    pub least_repetitions: u32,
    /// Doubts about all times.
    pub doubts: Doubts,
}

/// Seconds by repetition.
type Times = BTreeMap<u32, f64>;

/// The schedules of an image.
#[derive(Default)]
struct Schedules {
    /// Those that are compared with each other.
    compared: BTreeMap<String, Times>,
    /// Those whose matrix has fewer repetitions than the experiment.
    shown: BTreeMap<String, Times>,
}

/// Ranks the schedules in the folder of an experiment; with filters, only those that pass them.
pub fn ranking(lab: &Arc<Lab>, folder: &Path, filters: &[String]) -> Result<Ranking> {
    let records = folder.join("records.csv");
    let rows: Vec<Record> = read_records(&records)?.into_iter().filter(|row| row.error.is_empty()).collect();
    let run = read_run_file(&folder.join(MACHINE))?;
    let wanted = if filters.is_empty() { None } else { Some(wanted(lab, folder, &run.profile, filters)?) };
    let rows: Vec<&Record> =
        rows.iter().filter(|row| wanted.as_ref().is_none_or(|wanted| wanted.contains(&row.cell))).collect();
    let shown_only = if run.uncapped { BTreeSet::new() } else { shown_only(lab, folder, &run.profile) };
    let mut images: BTreeMap<ImageKey, Schedules> = BTreeMap::new();
    for row in &rows {
        let image = row.image_key();
        let schedule = row.cell.strip_prefix(&format!("{image}/")).unwrap_or(&row.cell).to_string();
        if let Some(seconds) = row.makespan_s.filter(|seconds| *seconds > 0.0 && seconds.is_finite()) {
            let own = images.entry(image).or_default();
            let own = if shown_only.contains(&row.cell) { &mut own.shown } else { &mut own.compared };
            own.entry(schedule).or_default().insert(row.repetition, seconds);
        }
    }
    images.retain(|_, schedules| schedules.compared.len() + schedules.shown.len() > 1);
    if images.is_empty() {
        let problem = "contains no image with two schedules, so there is nothing to rank";
        let error = InputError::new("folder", folder.display().to_string(), problem);
        return Err(error.allowed("the folder of an experiment with several schedules").into());
    }
    let sizes = || images.values().map(|schedules| schedules.compared.len());
    let tests = |size: usize| (size * size.saturating_sub(1)) as f64;
    let miss = MISS / sizes().map(tests).sum::<f64>().max(1.0);
    let comparisons = sizes().map(|size| size.saturating_sub(1)).sum::<usize>().max(1);
    let level = level_of(comparisons);
    let stopping = if run.until.is_some() { Stopping::Sequential } else { Stopping::Fixed };
    let least = sizes().filter(|size| *size > 1).map(|size| least(size, miss * tests(size), stopping));
    Ok(Ranking {
        least_repetitions: least.max().unwrap_or(0),
        doubts: Doubts::of(rows.iter().map(|row| row.warnings.as_str())),
        images: images
            .iter()
            .map(|(image, schedules)| ImageRanking {
                image: image.to_string(),
                places: placed(schedules, miss * tests(schedules.compared.len()), level, stopping),
                fastest: fastest(&schedules.compared, MISS / comparisons as f64, stopping),
                compared: schedules.compared.len(),
            })
            .collect(),
    })
}

/// The keys of rows whose matrix has fewer repetitions than its experiment; empty if no readable definition lies beside
/// the rows.
fn shown_only(lab: &Arc<Lab>, folder: &Path, profile: &str) -> BTreeSet<String> {
    let capped = cells(lab, folder, profile).unwrap_or_default().into_iter().filter(|cell| cell.at_most.is_some());
    capped.flat_map(|cell| cell.points).map(|point| point.id).collect()
}

/// The cells of the definition that lies beside rows.
fn cells(lab: &Arc<Lab>, folder: &Path, profile: &str) -> Result<Vec<Cell>> {
    let path = folder.join("experiment.toml");
    let name = folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let definition = Definition::from_text(lab, &name, &path.display().to_string(), &read_text(&path)?)?;
    definition.cells(Profile::from_name(profile).unwrap_or(Profile::Quick))
}

/// The keys of rows that pass the filters.
fn wanted(lab: &Arc<Lab>, folder: &Path, profile: &str, filters: &[String]) -> Result<BTreeSet<String>> {
    let mut wanted = BTreeSet::new();
    for cell in cells(lab, folder, profile)? {
        let mut is_wanted = true;
        for filter in filters {
            is_wanted &= cell.matches(filter)?;
        }
        if is_wanted {
            wanted.extend(cell.points.into_iter().map(|point| point.id));
        }
    }
    Ok(wanted)
}

/// The pairs (faster, slower) of schedules that are told apart. If repetitions had a goal, each pair's median ratio has
/// an interval that holds at every look, and the intervals of all pairs hold together.
fn orders(times: &[Times], miss: f64, stopping: Stopping) -> BTreeSet<(usize, usize)> {
    if stopping == Stopping::Fixed {
        return told_apart(times, miss);
    }
    let mut told = BTreeSet::new();
    for (a, of_a) in times.iter().enumerate() {
        for (b, of_b) in times.iter().enumerate().take(a) {
            match order_so_far(of_a, of_b, 1.0 - sequence_level(times.len(), miss)) {
                Some(Ordering::Greater) => told.insert((b, a)),
                Some(Ordering::Less) => told.insert((a, b)),
                _ => false,
            };
        }
    }
    told
}

/// The confidence of each pair's interval with which the intervals of all pairs hold together.
fn sequence_level(schedules: usize, miss: f64) -> f64 {
    1.0 - 2.0 * miss / (schedules * schedules.saturating_sub(1)).max(1) as f64
}

/// The fewest repetitions that can tell any two of `schedules` schedules apart.
fn least(schedules: usize, miss: f64, stopping: Stopping) -> u32 {
    if stopping == Stopping::Fixed {
        return least_blocks(schedules, miss);
    }
    let is_enough =
        |count: &u32| median_sequence(&vec![1.0; *count as usize], sequence_level(schedules, miss)).is_some();
    (1..MOST_REPETITIONS).find(is_enough).unwrap_or(MOST_REPETITIONS)
}

/// The schedules that are not known to be slower than another, with a miss probability for each comparison.
fn fastest(schedules: &BTreeMap<String, Times>, miss: f64, stopping: Stopping) -> Vec<String> {
    let is_left = may_be_least(&schedules.values().collect::<Vec<_>>(), miss, stopping);
    schedules.keys().zip(is_left).filter(|(_, is_left)| *is_left).map(|(name, _)| name.clone()).collect()
}

/// Schedules sorted by the median of their times, each divided by the median time of its repetition.
fn ordered(schedules: &BTreeMap<String, Times>) -> Vec<(&String, &Times)> {
    let mut blocks: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
    for (repetition, seconds) in schedules.values().flatten() {
        blocks.entry(*repetition).or_default().push(*seconds);
    }
    let usual: BTreeMap<u32, f64> =
        blocks.into_iter().filter_map(|(repetition, times)| Some((repetition, median(&times)?))).collect();
    let score = |times: &Times| {
        let shares: Vec<f64> = times.iter().map(|(repetition, seconds)| seconds / usual[repetition]).collect();
        median(&shares).unwrap_or(f64::INFINITY)
    };
    let mut ordered: Vec<(&String, &Times)> = schedules.iter().collect();
    ordered.sort_by(|(_, a), (_, b)| score(a).total_cmp(&score(b)));
    ordered
}

/// The schedules that are compared, the fastest first, and then the others, which are in no group.
fn placed(schedules: &Schedules, miss: f64, level: f64, stopping: Stopping) -> Vec<Place> {
    let (compared, shown) = (ordered(&schedules.compared), ordered(&schedules.shown));
    let Some((_, first)) = compared.first().or(shown.first()) else { return Vec::new() };
    let times: Vec<Times> = compared.iter().map(|(_, times)| (*times).clone()).collect();
    let sets = groups(times.len(), &orders(&times, miss, stopping));
    let place = |(at, (schedule, own)): (usize, &(&String, &Times))| {
        let ratios: Vec<f64> = own.iter().filter_map(|(at, seconds)| Some(seconds / first.get(at)?)).collect();
        let interval = stopping.median_interval(&ratios, level).filter(|interval| at > 0 && interval.level >= level);
        Some(Place {
            schedule: (*schedule).clone(),
            median_s: median(&own.values().copied().collect::<Vec<_>>())?,
            ratio: median(&ratios)?,
            interval,
            repetitions: own.len(),
            groups: sets.iter().enumerate().filter(|(_, set)| set.contains(&at)).map(|(number, _)| number).collect(),
        })
    };
    compared.iter().chain(&shown).enumerate().filter_map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(factor: f64) -> Times {
        (0..9).map(|at| (at, factor * (1.0 + 0.4 * f64::from(at % 3)))).collect()
    }

    /// Two schedules that are faster in turns, and one that always takes twice as long, on a machine whose speed
    /// drifts.
    #[test]
    fn the_fastest_come_first_and_those_that_cannot_be_told_apart_share_a_group() {
        let mut b = times(1.0);
        for (at, seconds) in &mut b {
            *seconds *= if at % 2 == 0 { 1.01 } else { 0.99 };
        }
        let schedules =
            BTreeMap::from([("a".to_string(), times(2.0)), ("b".to_string(), b), ("c".to_string(), times(1.0))]);
        let schedules = Schedules { compared: schedules, ..Schedules::default() };
        let places = placed(&schedules, 0.05, level_of(2), Stopping::Fixed);
        let names: Vec<(&str, &[usize])> = places.iter().map(|p| (p.schedule.as_str(), p.groups.as_slice())).collect();
        assert_eq!(names, [("c", &[0][..]), ("b", &[0]), ("a", &[1])]);
        assert_eq!((places[0].ratio, places[0].interval), (1.0, None));
        assert_eq!(places[2].ratio, 2.0);
        let interval = places[2].interval.unwrap();
        assert_eq!((interval.low, interval.high), (2.0, 2.0));
        assert!(places.iter().all(|place| place.repetitions == 9));
    }

    /// A schedule with three repetitions gets a ratio but no group, however fast it is.
    #[test]
    fn schedules_of_fewer_repetitions_come_last_and_in_no_group() {
        let fast: Times = times(0.5).into_iter().take(3).collect();
        let schedules = Schedules {
            compared: BTreeMap::from([("slow".to_string(), times(2.0)), ("usual".to_string(), times(1.0))]),
            shown: BTreeMap::from([("fast".to_string(), fast)]),
        };
        let places = placed(&schedules, 0.05, level_of(1), Stopping::Fixed);
        let told: Vec<(&str, f64, &[usize])> =
            places.iter().map(|place| (place.schedule.as_str(), place.ratio, place.groups.as_slice())).collect();
        assert_eq!(told, [("usual", 1.0, &[0][..]), ("slow", 2.0, &[1]), ("fast", 0.5, &[])]);
        assert_eq!(places[2].interval, None);
    }

    /// A schedule that shares no repetition with the first gets no place, instead of a ratio of NaN.
    #[test]
    fn a_schedule_without_a_common_repetition_has_no_place() {
        let elsewhere: Times = times(3.0).into_iter().map(|(at, seconds)| (at + 100, seconds)).collect();
        let schedules = BTreeMap::from([
            ("a".to_string(), times(1.0)),
            ("b".to_string(), times(1.1)),
            ("z".to_string(), elsewhere),
        ]);
        let schedules = Schedules { compared: schedules, ..Schedules::default() };
        let places = placed(&schedules, 0.05, level_of(2), Stopping::Fixed);
        assert!(places.iter().all(|place| place.ratio.is_finite()), "{places:?}");
    }

    /// Two comparisons, one with each other schedule: six repetitions in the same order suffice (1/64 <= .05 / 2), five
    /// do not (1/32).
    #[test]
    fn the_fastest_is_among_those_that_none_is_faster_than() {
        let of = |count: u32, factor: f64| (0..count).map(|at| (at, factor)).collect::<Times>();
        let left = |count: u32, stopping: Stopping| {
            let three =
                [("a", 1.0), ("b", 1.1), ("c", 2.0)].map(|(name, factor)| (name.to_string(), of(count, factor)));
            fastest(&BTreeMap::from(three), MISS / 2.0, stopping).len()
        };
        assert_eq!((left(5, Stopping::Fixed), left(6, Stopping::Fixed)), (3, 1));
        assert_eq!((left(7, Stopping::Sequential), left(8, Stopping::Sequential)), (3, 1));
    }
}
