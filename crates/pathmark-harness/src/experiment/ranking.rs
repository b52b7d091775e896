//! Rankings of the schedules of an image by speed, from the rows of an experiment.
//!
//! A repetition of an image is a block: its rows were measured shortly after each other, so machine drift affects all
//! of them. Schedules without a common block, such as those of two parts of a sweep, are ranked apart.

use super::Cell;
use super::definition::Definition;
use super::diff::{Times, is_in_pairs, level_of, of_processes};
use super::packed_rows::records_path;
use super::profile::Profile;
use super::records_file::read_records;
use super::run_file::{MACHINE, read_run_file};
use super::stopping_rule::MOST_REPETITIONS;
use super::together::{Schedules, Timed, parts};
use super::turns::turns;
use crate::analysis::Interval;
use crate::analysis::adjacent_pairs::{FEWEST_PROCESSES, by_process, paired_ratio};
use crate::analysis::confidence_sequence::{Stopping, median_sequence};
use crate::analysis::quantile::median;
use crate::analysis::ranking::{
    Turn, groups, least_blocks, may_be_least, may_be_least_in_pairs, order_so_far, ratios_in_pairs, told_apart,
    told_apart_in_pairs,
};
use crate::error::{InputError, Result};
use crate::input::read_text;
use crate::lab::Lab;
use crate::measure::{ImageKey, Record, TimingConcerns};
use serde::Serialize;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

/// The probability that any reported order is wrong.
pub(super) const MISS: f64 = 0.05;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Place {
    /// The schedule: the part of its cells' names after the image.
    pub schedule: String,
    pub median_s: f64,
    /// Time relative to the first schedule: the median of the ratios within a repetition; `None` without a common one.
    pub ratio: Option<f64>,
    /// The interval of the ratio; the intervals of all places hold together with 95 % confidence. `None` for the first
    /// place, and with too few repetitions.
    pub interval: Option<Interval>,
    pub repetitions: usize,
    /// Numbers of the groups that it belongs to, from 0. Two schedules that share a group cannot be told apart.
    pub groups: Vec<usize>,
}

/// The schedules of an image that were measured together, the fastest first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImageRanking {
    pub image: String,
    /// The number of this part of the image's schedules, from 1, and the number of parts.
    pub part: [usize; 2],
    pub places: Vec<Place>,
    /// The schedules that are not known to be slower than another: with 95 % confidence, for all images together, the
    /// fastest is among them. Schedules whose matrix limits their repetitions are not compared.
    pub fastest: Vec<String>,
    pub compared: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ranking {
    pub images: Vec<ImageRanking>,
    /// The cells that have no time, because their rows failed.
    pub without_time: Vec<String>,
    /// The fewest repetitions that can tell any two schedules apart.
    pub least_repetitions: u32,
    #[serde(rename = "doubted_rows")]
    pub doubts: TimingConcerns,
}

/// Ranks the schedules in the folder of an experiment; with filters, only those that pass them.
pub fn ranking(lab: &Arc<Lab>, folder: &Path, filters: &[String]) -> Result<Ranking> {
    let rows = read_records(&records_path(folder))?;
    let run = read_run_file(&folder.join(MACHINE))?;
    let wanted = if filters.is_empty() { None } else { Some(wanted(lab, folder, &run.profile, filters)?) };
    let turns = turns(&rows);
    let rows: Vec<(&Record, Turn)> = (rows.iter().zip(turns))
        .filter(|(row, _)| wanted.as_ref().is_none_or(|wanted| wanted.contains(&row.cell)))
        .collect();
    let shown_only = if run.uncapped { BTreeSet::new() } else { shown_only(lab, folder, &run.profile) };
    let (with_time, without): (Vec<_>, Vec<_>) = rows.iter().copied().partition(|(row, _)| seconds(row).is_some());
    let timed: BTreeSet<&str> = with_time.iter().map(|(row, _)| row.cell.as_str()).collect();
    let failed: BTreeSet<&str> = without.iter().map(|(row, _)| row.cell.as_str()).collect();
    let mut images = schedules_of(with_time, &shown_only);
    images.retain(|_, schedules| schedules.len() > 1);
    if images.is_empty() {
        let problem = "contains no image with two schedules, so there is nothing to rank";
        let error = InputError::new("folder", folder.display().to_string(), problem);
        return Err(error.allowed("the folder of an experiment with several schedules").into());
    }
    let parts: Vec<(&ImageKey, Vec<Schedules>)> =
        images.iter().map(|(image, schedules)| (image, parts(schedules))).collect();
    let sizes = || parts.iter().flat_map(|(_, parts)| parts).map(compared);
    let tests = |size: usize| (size * size.saturating_sub(1)) as f64;
    let miss = MISS / sizes().map(tests).sum::<f64>().max(1.0);
    let comparisons = sizes().map(|size| size.saturating_sub(1)).sum::<usize>().max(1);
    let level = level_of(comparisons);
    let stopping = run.stopping();
    let ranked = parts.iter().flat_map(|(_, parts)| parts).filter(|part| compared(part) > 1);
    let least = ranked.map(|part| match compared(part) {
        _ if stopping == Stopping::Fixed && part.values().any(|own| is_in_pairs(&own.times)) => FEWEST_PROCESSES as u32,
        size => least_repetitions(size, miss * tests(size), stopping),
    });
    let of_part = |image: &ImageKey, part: &Schedules, number: [usize; 2]| ImageRanking {
        image: image.to_string(),
        part: number,
        places: placed(part, miss * tests(compared(part)), level, stopping),
        fastest: fastest(part, MISS / comparisons as f64, stopping),
        compared: compared(part),
    };
    let rankings = parts.iter().flat_map(|(image, parts)| {
        (1..).zip(parts).map(move |(number, part)| of_part(image, part, [number, parts.len()]))
    });
    Ok(Ranking {
        images: rankings.collect(),
        without_time: failed.difference(&timed).map(|cell| (*cell).to_string()).collect(),
        least_repetitions: least.max().unwrap_or(0),
        doubts: TimingConcerns::of(
            rows.iter().filter(|(row, _)| row.error.is_empty()).map(|(row, _)| row.warnings.as_str()),
        ),
    })
}

/// The seconds of a row that did not fail.
fn seconds(row: &Record) -> Option<f64> {
    row.makespan_s.filter(|_| row.error.is_empty())
}

/// The schedules of each image with their times. Those of the cells in `shown_only` are not compared.
pub(super) fn schedules_of<'a>(
    rows: impl IntoIterator<Item = (&'a Record, Turn)>,
    shown_only: &BTreeSet<String>,
) -> BTreeMap<ImageKey, Schedules> {
    let mut images: BTreeMap<ImageKey, Schedules> = BTreeMap::new();
    for (row, turn, seconds) in rows.into_iter().filter_map(|(row, turn)| Some((row, turn, seconds(row)?))) {
        let image = row.image_key();
        let schedule = row.cell.strip_prefix(&format!("{image}/")).unwrap_or(&row.cell).to_string();
        let role =
            || Timed { is_serial: row.is_serial(), is_shown_only: shown_only.contains(&row.cell), ..Timed::default() };
        let own = images.entry(image).or_default().entry(schedule).or_insert_with(role);
        own.times.insert(turn, seconds);
    }
    images
}

/// The orders (faster, slower) of an image's schedules that are told apart, each within a part that was measured together.
/// `miss` bounds the probability that any of them is wrong.
pub(super) fn told_orders(schedules: &Schedules, miss: f64, stopping: Stopping) -> BTreeSet<(String, String)> {
    let parts = parts(schedules);
    let mut told = BTreeSet::new();
    for part in &parts {
        let (names, times): (Vec<&String>, Vec<Times>) =
            part.iter().filter(|(_, own)| !own.is_shown_only).map(|(name, own)| (name, own.times.clone())).unzip();
        let of_part = orders(&times, miss / parts.len() as f64, stopping).into_iter();
        told.extend(of_part.map(|(faster, slower)| (names[faster].clone(), names[slower].clone())));
    }
    told
}

fn compared(schedules: &Schedules) -> usize {
    schedules.values().filter(|own| !own.is_shown_only).count()
}

/// The keys of rows whose matrix has fewer repetitions than its experiment; empty if no readable definition lies beside
/// the rows.
fn shown_only(lab: &Arc<Lab>, folder: &Path, profile: &str) -> BTreeSet<String> {
    capped(&cells(lab, folder, profile).unwrap_or_default())
}

/// The keys of the rows of cells whose matrix has fewer repetitions than the experiment.
pub(super) fn capped(cells: &[Cell]) -> BTreeSet<String> {
    let capped = cells.iter().filter(|cell| cell.at_most.is_some());
    capped.flat_map(|cell| &cell.points).map(|point| point.id.clone()).collect()
}

fn cells(lab: &Arc<Lab>, folder: &Path, profile: &str) -> Result<Vec<Cell>> {
    let path = folder.join("experiment.toml");
    let name = folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let definition = Definition::from_text(lab, &name, &path.display().to_string(), &read_text(&path)?)?;
    definition.cells(Profile::from_name(profile).unwrap_or(Profile::Quick))
}

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
        let in_pairs = times.iter().any(is_in_pairs);
        return if in_pairs { told_apart_in_pairs(times, miss) } else { told_apart(times, miss) };
    }
    let times: Vec<Times> = times.iter().map(of_processes).collect();
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

/// The fewest repetitions that can tell any two of so many schedules apart.
pub(super) fn least_repetitions(schedules: usize, miss: f64, stopping: Stopping) -> u32 {
    if stopping == Stopping::Fixed {
        return least_blocks(schedules, miss);
    }
    let is_enough =
        |count: &u32| median_sequence(&vec![1.0; *count as usize], sequence_level(schedules, miss)).is_some();
    (1..MOST_REPETITIONS).find(is_enough).unwrap_or(MOST_REPETITIONS)
}

/// The schedules that are not known to be slower than another, with a miss probability for each comparison.
fn fastest(schedules: &Schedules, miss: f64, stopping: Stopping) -> Vec<String> {
    let compared = || schedules.iter().filter(|(_, own)| !own.is_shown_only);
    let times: Vec<&Times> = compared().map(|(_, own)| &own.times).collect();
    let is_left = if stopping == Stopping::Fixed && times.iter().any(|times| is_in_pairs(times)) {
        may_be_least_in_pairs(&times, miss)
    } else {
        let times: Vec<Times> = times.into_iter().map(of_processes).collect();
        may_be_least(&times.iter().collect::<Vec<_>>(), miss, stopping)
    };
    compared().zip(is_left).filter(|(_, is_left)| *is_left).map(|((name, _), _)| name.clone()).collect()
}

/// Schedules sorted by the median of their times, each divided by the median time of its repetition.
fn ordered(schedules: &Schedules, is_shown_only: bool) -> Vec<(&String, &Times)> {
    let own =
        || schedules.iter().filter(|(_, own)| own.is_shown_only == is_shown_only).map(|(name, own)| (name, &own.times));
    let mut blocks: BTreeMap<Turn, Vec<f64>> = BTreeMap::new();
    for (turn, seconds) in own().flat_map(|(_, times)| times) {
        blocks.entry(*turn).or_default().push(*seconds);
    }
    let usual: BTreeMap<Turn, f64> =
        blocks.into_iter().filter_map(|(turn, times)| Some((turn, median(&times)?))).collect();
    let score = |times: &Times| {
        let shares: Vec<f64> = times.iter().map(|(turn, seconds)| seconds / usual[turn]).collect();
        median(&shares).unwrap_or(f64::INFINITY)
    };
    let mut ordered: Vec<(f64, (&String, &Times))> = own().map(|(name, times)| (score(times), (name, times))).collect();
    ordered.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    ordered.into_iter().map(|(_, own)| own).collect()
}

/// The schedules that are compared, the fastest first, and then the others, which are in no group.
fn placed(schedules: &Schedules, miss: f64, level: f64, stopping: Stopping) -> Vec<Place> {
    let (compared, shown) = (ordered(schedules, false), ordered(schedules, true));
    let Some((_, first)) = compared.first().or(shown.first()) else { return Vec::new() };
    let times: Vec<Times> = compared.iter().map(|(_, times)| (*times).clone()).collect();
    let mut groups_of = vec![Vec::new(); compared.len() + shown.len()];
    for (number, set) in groups(times.len(), &orders(&times, miss, stopping)).into_iter().enumerate() {
        for member in set {
            groups_of[member].push(number);
        }
    }
    let place = |(at, (schedule, own)): (usize, &(&String, &Times))| {
        let ratios = ratios_in_pairs(own, first);
        let (ratio, interval) = if is_in_pairs(own) && stopping == Stopping::Fixed {
            let found = paired_ratio(&by_process(ratios), level).map(|found| found.ratio);
            (if at == 0 { Some(1.0) } else { found.map(|found| found.value) }, found.map(|found| found.interval))
        } else {
            let ratios: Vec<f64> = by_process(ratios).iter().filter_map(|own| median(own)).collect();
            (median(&ratios), stopping.median_interval(&ratios, level))
        };
        Some(Place {
            schedule: (*schedule).clone(),
            median_s: median(&own.values().copied().collect::<Vec<_>>())?,
            ratio,
            interval: interval.filter(|interval| at > 0 && interval.level >= level),
            repetitions: own.keys().map(|(process, _)| process).collect::<BTreeSet<_>>().len(),
            groups: groups_of[at].clone(),
        })
    };
    compared.iter().chain(&shown).enumerate().filter_map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn schedules<const COUNT: usize>(all: [(&str, Times, bool); COUNT]) -> Schedules {
        let timed = |times, is_shown_only| Timed { times, is_serial: false, is_shown_only };
        all.into_iter().map(|(name, times, is_shown)| (name.to_string(), timed(times, is_shown))).collect()
    }

    fn times(factor: f64) -> Times {
        (0..9).map(|at| ((at, None), factor * (1.0 + 0.4 * f64::from(at % 3)))).collect()
    }

    /// Two schedules that are faster in turns, and one that always takes twice as long, on a machine whose speed
    /// drifts.
    #[test]
    fn the_fastest_come_first_and_those_that_cannot_be_told_apart_share_a_group() {
        let mut b = times(1.0);
        for ((at, _), seconds) in &mut b {
            *seconds *= if at % 2 == 0 { 1.01 } else { 0.99 };
        }
        let schedules = schedules([("a", times(2.0), false), ("b", b, false), ("c", times(1.0), false)]);
        let places = placed(&schedules, 0.05, level_of(2), Stopping::Fixed);
        let names: Vec<(&str, &[usize])> = places.iter().map(|p| (p.schedule.as_str(), p.groups.as_slice())).collect();
        assert_eq!(names, [("c", &[0][..]), ("b", &[0]), ("a", &[1])]);
        assert_eq!((places[0].ratio, places[0].interval), (Some(1.0), None));
        assert_eq!(places[2].ratio, Some(2.0));
        let interval = places[2].interval.unwrap();
        assert_eq!((interval.low, interval.high), (2.0, 2.0));
        assert!(places.iter().all(|place| place.repetitions == 9));
    }

    /// A schedule with three repetitions gets a ratio but no group, however fast it is.
    #[test]
    fn schedules_of_fewer_repetitions_come_last_and_in_no_group() {
        let fast: Times = times(0.5).into_iter().take(3).collect();
        let schedules = schedules([("slow", times(2.0), false), ("usual", times(1.0), false), ("fast", fast, true)]);
        let places = placed(&schedules, 0.05, level_of(1), Stopping::Fixed);
        let told: Vec<(&str, f64, &[usize])> = places
            .iter()
            .map(|place| (place.schedule.as_str(), place.ratio.unwrap(), place.groups.as_slice()))
            .collect();
        assert_eq!(told, [("usual", 1.0, &[0][..]), ("slow", 2.0, &[1]), ("fast", 0.5, &[])]);
        assert_eq!(places[2].interval, None);
    }

    /// A schedule that shares no repetition with the first one has no ratio, but a place.
    #[test]
    fn every_schedule_has_a_place() {
        let elsewhere: Times = times(3.0).into_iter().map(|((at, _), seconds)| ((at + 100, None), seconds)).collect();
        let schedules = schedules([("a", times(1.0), false), ("b", times(1.1), false), ("z", elsewhere, false)]);
        let places = placed(&schedules, 0.05, level_of(2), Stopping::Fixed);
        let ratios: BTreeMap<&str, Option<f64>> = places
            .iter()
            .map(|place| (place.schedule.as_str(), place.ratio.map(|ratio| (10.0 * ratio).round())))
            .collect();
        assert_eq!(ratios, BTreeMap::from([("a", Some(10.0)), ("b", Some(11.0)), ("z", None)]));
    }

    /// Two comparisons, one with each other schedule: six repetitions in the same order suffice (1/64 <= .05 / 2), five
    /// do not (1/32).
    #[test]
    fn the_fastest_is_among_those_that_none_is_faster_than() {
        let of = |count: u32, factor: f64| (0..count).map(|at| ((at, None), factor)).collect::<Times>();
        let left = |count: u32, stopping: Stopping| {
            let three = [("a", 1.0), ("b", 1.1), ("c", 2.0)].map(|(name, factor)| (name, of(count, factor), false));
            fastest(&schedules(three), MISS / 2.0, stopping).len()
        };
        assert_eq!((left(5, Stopping::Fixed), left(6, Stopping::Fixed)), (3, 1));
        assert_eq!((left(7, Stopping::Sequential), left(8, Stopping::Sequential)), (3, 1));
    }
}
