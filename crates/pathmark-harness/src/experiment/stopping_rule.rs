//! Repetitions until a goal is reached: `run EXPERIMENT --until 3%`, or `repetitions = { until = "3 %" }` in its file.
//!
//! With a share as the goal, cells are decided one by one. With another build beside this one (`--baseline OLD`), a cell is decided when the
//! interval of its ratio of times lies above 1 plus the limit, below 1, or within the limit of 1. Otherwise it is decided when its speedup over
//! the serial run of its image, or its time where there is no serial run, is known to within the limit. With `fastest` or `order` as the goal, the
//! schedules of an image are compared with each other.
//!
//! Intervals hold at every look ([`crate::analysis::confidence_sequence`]), so they stay valid when repetitions stop by
//! them. Decided cells are left out of later repetitions; serial runs are repeated beside the cells that are compared
//! with them.

use super::diff::{Change, Judge, Pairing, Times, of_processes, parse_share, turn};
use super::ranking::MISS;
use super::{Definition, Options};
use crate::analysis::adjacent_pairs::{PairedRatio, by_process, paired_ratio};
use crate::analysis::confidence_sequence::{Stopping, median_sequence};
use crate::analysis::quantile::median;
use crate::analysis::ranking::{may_be_least, order_so_far, ratios_in_pairs};
use crate::analysis::{Estimate, Interval};
use crate::error::{InputError, Result};
use crate::measure::Record;
use std::collections::{HashMap, HashSet};
use std::time::Duration;

/// Confidence of each interval, as in the figures of an experiment.
const LEVEL: f64 = 0.95;

/// The largest number of repetitions until a goal, if the user sets none.
pub const MOST_REPETITIONS: u32 = 200;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// The share that decides a cell: with two builds the limit of its ratio of times, with one build the precision of
    /// its speedup or time.
    Share(f64),
    /// The fastest schedule of each image: a cell is left out once another one is faster (successive elimination: E. Even-Dar, S. Mannor and
    /// Y. Mansour, "Action elimination and stopping conditions for the multi-armed bandit and reinforcement learning problems", 2006).
    Fastest,
    /// The order of the schedules of each image: a cell is left out once it is told apart from every other one.
    Order,
}

impl Goal {
    const WORDS: [(&'static str, Self); 2] = [("fastest", Self::Fastest), ("order", Self::Order)];

    pub(super) fn is_of_schedules(self) -> bool {
        Self::WORDS.iter().any(|(_, goal)| *goal == self)
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct StoppingRule {
    pub goal: Goal,
    pub text: String,
    /// The time after which no repetition begins, from the start of the first one.
    pub max_time: Option<Duration>,
}

impl StoppingRule {
    /// Parses a goal (`3%`, `0.03`, `fastest` or `order`) and a time (`60s`).
    pub fn parse(goal: &str, max_time: Option<&str>) -> Result<Self> {
        let max_time = max_time.map(parse_max_time).transpose()?;
        let word = Goal::WORDS.iter().find(|(word, _)| *word == goal.trim());
        let goal_of = word.map_or_else(|| share(goal).map(Goal::Share), |(_, goal)| Ok(*goal));
        Ok(Self { goal: goal_of?, text: goal.to_string(), max_time })
    }

    /// The goal of a sweep: the command's, or the definition's if the command sets neither goal nor repetitions.
    pub(super) fn of(definition: &Definition, options: &Options) -> Result<Option<Self>> {
        let until = match &options.until {
            Some(until) => Some(until.clone()),
            None if options.repetitions.is_some() => None,
            // With two builds, or for a part of a sweep, a goal of the definition that compares schedules does not
            // apply.
            None => {
                let own = definition.until(options.profile)?;
                own.filter(|until| !until.goal.is_of_schedules() || is_of_all_schedules(options).is_ok()).cloned()
            }
        };
        if let Some(until) = until.as_ref().filter(|until| until.goal.is_of_schedules()) {
            is_of_all_schedules(options).map_err(|problem| {
                InputError::new("until", &until.text, problem).allowed("a share such as 3%, or --repetitions")
            })?;
        }
        Ok(until)
    }

    /// Whether the time limit has passed, so that no repetition may begin.
    pub(super) fn is_over(&self, elapsed: Duration) -> bool {
        self.max_time.is_some_and(|max_time| elapsed >= max_time)
    }
}

impl Options {
    /// Whether the command, and not the definition, sets the repetitions; they then hold for all cells.
    pub(super) fn say_how_often(&self) -> bool {
        self.repetitions.is_some() || self.until.is_some()
    }
}

/// Checks that a sweep compares all schedules of its images with each other; the error says why it does not.
fn is_of_all_schedules(options: &Options) -> std::result::Result<(), &'static str> {
    match (&options.baseline, &options.shard) {
        (Some(_), _) => Err("compares schedules with each other, but --baseline compares each with another build"),
        (_, Some(_)) => Err("compares all schedules of an image, but a part of a sweep has only some of them"),
        (None, None) => Ok(()),
    }
}

pub(super) fn parse_max_time(text: &str) -> Result<Duration> {
    let wrong =
        || InputError::new("max-time", text, "is not a duration").allowed("a number with a unit, as in 60s or 2min");
    Ok(humantime::parse_duration(text).map_err(|_| wrong())?)
}

/// Parses a share that repetitions can reach: above 0.
fn share(text: &str) -> Result<f64> {
    let wrong = |problem: &str| {
        let error = InputError::new("until", text, problem);
        error.allowed("fastest, order, or a share above 0, such as 3%")
    };
    let share = parse_share("until", text).map_err(|_| wrong("is neither a goal nor a share"))?;
    if share <= 0.0 {
        return Err(wrong("cannot be reached: every interval of times is wider than 0").into());
    }
    Ok(share)
}

/// Half of a ratio's interval, as a share of the ratio.
pub(super) fn half_width(found: &PairedRatio) -> f64 {
    let Estimate { value, interval } = found.ratio;
    0.5 * (interval.high - interval.low) / value
}

/// The seconds of both builds so far, by cell and repetition.
#[derive(Default)]
pub(super) struct Decisions {
    times: HashMap<String, [Times; 2]>,
    /// Cells with a row that has no time: it failed, or the machine lacks something that the cell needs.
    without_time: HashSet<String>,
}

impl Decisions {
    pub(super) fn note(&mut self, record: &Record, is_new: bool) {
        if let Some(seconds) = record.makespan_s.filter(|seconds| record.error.is_empty() && *seconds > 0.0) {
            let times = self.times.entry(record.cell.clone()).or_default();
            times[usize::from(is_new)].insert(turn(record), seconds);
        } else {
            self.without_time.insert(record.cell.clone());
        }
    }

    /// Whether a cell, one of `cells` that are compared, is decided.
    pub(super) fn is_decided(&self, cell: &str, cells: usize, limit: f64) -> bool {
        let Some([old, new]) = self.times.get(cell) else { return false };
        let found = Judge::new(cells, limit).compare(cell, Pairing::Sequential, old, new);
        found.is_some_and(|found| found.change != Change::Undecided)
    }

    /// Whether a cell's speedup over its serial run, or its time if it has none, is known to within the limit on either
    /// side. A cell without a time counts as known, because more repetitions would not help.
    pub(super) fn is_known(&self, cell: &str, serial: Option<&str>, limit: f64) -> bool {
        if self.without_time.contains(cell) {
            return true;
        }
        let times = |cell: &str| self.times.get(cell).map(|[_, new]| new);
        let Some(own) = times(cell) else { return false };
        let values: Vec<f64> = match serial {
            None => own.values().copied().collect(),
            Some(serial) => {
                let Some(serial) = times(serial) else { return self.without_time.contains(serial) };
                own.iter().filter_map(|(turn, own)| Some(serial.get(turn)? / own)).collect()
            }
        };
        let width = |(middle, interval): (f64, Interval)| (interval.high - interval.low) / middle;
        median(&values).zip(median_sequence(&values, LEVEL)).is_some_and(|found| width(found) <= 2.0 * limit)
    }

    /// The ratio of two cells that run side by side, of each seed; from the processes below a number.
    pub(super) fn paired(&self, seeds: &[(&str, &str)], end: u32) -> Option<PairedRatio> {
        let mut processes = Vec::new();
        for (what, with) in seeds {
            let [[_, what], [_, with]] = [self.times.get(*what)?, self.times.get(*with)?];
            let ratios = ratios_in_pairs(what, with).into_iter().filter(|(process, _)| *process < end);
            processes.extend(by_process(ratios));
        }
        paired_ratio(&processes, LEVEL)
    }

    /// Whether the ratio of two cells that run side by side is known to within the limit, or cannot be known.
    pub(super) fn is_paired(&self, what: &str, with: &str, limit: f64) -> bool {
        let is_without = [what, with].iter().any(|cell| self.without_time.contains(*cell));
        is_without || self.paired(&[(what, with)], u32::MAX).is_some_and(|found| half_width(&found) <= limit)
    }

    /// Which cells are open, image by image. For the fastest schedule, a cell is open until another one is known to be
    /// faster; for the order, until it is told apart from all others. The probability of any wrong conclusion, over all
    /// images, is at most 5 %.
    pub(super) fn open_schedules(&self, images: &[Vec<&str>], goal: Goal) -> Vec<Vec<bool>> {
        let comparisons = |cells: usize| match goal {
            // Only comparisons with the fastest cell can eliminate it.
            Goal::Fastest => cells.saturating_sub(1),
            _ => cells * cells.saturating_sub(1) / 2,
        };
        let all: usize = images.iter().map(|cells| comparisons(cells.len())).sum();
        let miss = MISS / all.max(1) as f64;
        images.iter().map(|cells| self.open_of(cells, goal, miss)).collect()
    }

    /// [`Self::open_schedules`] for one image, with a miss probability for each comparison.
    fn open_of(&self, cells: &[&str], goal: Goal, miss: f64) -> Vec<bool> {
        let times_of = |cell: &str| self.times.get(cell).map_or_else(Times::new, |[_, new]| of_processes(new));
        let (timed, times): (Vec<usize>, Vec<Times>) = cells
            .iter()
            .enumerate()
            .filter(|(_, cell)| !self.without_time.contains(**cell))
            .map(|(at, cell)| (at, times_of(cell)))
            .unzip();
        let is_open: Vec<bool> = if goal == Goal::Fastest {
            may_be_least(&times.iter().collect::<Vec<_>>(), miss, Stopping::Sequential)
        } else {
            let is_open = |own: usize| {
                let mut others = (0..times.len()).filter(|other| *other != own);
                others.any(|other| order_so_far(&times[own], &times[other], miss).is_none())
            };
            (0..times.len()).map(is_open).collect()
        };
        let mut open = vec![false; cells.len()];
        // If only one is left, it is the fastest.
        if is_open.iter().filter(|is_open| **is_open).count() > 1 {
            timed.into_iter().zip(is_open).for_each(|(at, is_open)| open[at] = is_open);
        }
        open
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noted(cells: &[(&str, &[f64])]) -> Decisions {
        let mut decisions = Decisions::default();
        for (cell, times) in cells {
            for (repetition, seconds) in (0..).zip(*times) {
                let makespan_s = Some(*seconds).filter(|seconds| seconds.is_finite());
                let record = Record { cell: (*cell).to_string(), repetition, makespan_s, ..Record::default() };
                decisions.note(&record, true);
            }
        }
        decisions
    }

    /// An interval that holds at every look needs at least eight values; with eight it spans all of them.
    #[test]
    fn known_speedups_are_within_the_limit() {
        let (drift, twice) = ([1.0, 2.0, 1.0, 3.0, 1.0, 2.0, 1.0, 2.0], [2.0, 4.0, 2.0, 6.0, 2.0, 4.0, 2.0, 4.0]);
        let seven = &twice[..7];
        let decisions = noted(&[("serial", &drift), ("steady", &twice), ("seven", seven), ("alone", &drift)]);
        assert!(decisions.is_known("steady", Some("serial"), 0.001), "drift falls on both");
        assert!(!decisions.is_known("seven", Some("serial"), 0.9), "seven values have no interval");
        // The interval from 1 to 3 has width 2, which is 1.33 times the median of 1.5: two thirds on either side.
        assert!(decisions.is_known("alone", None, 0.667) && !decisions.is_known("alone", None, 0.66));
        assert!(!decisions.is_known("absent", None, 0.9) && !decisions.is_known("steady", Some("absent"), 0.9));
    }

    #[test]
    fn a_cell_without_a_time_is_not_waited_for() {
        let decisions = noted(&[("failed", &[f64::NAN]), ("sound", &[1.0; 9])]);
        assert!(decisions.is_known("failed", None, 0.01) && decisions.is_known("sound", None, 0.01));
        assert!(decisions.is_known("sound", Some("failed"), 0.01));
    }

    /// After n repetitions in the same order the stake is nearly 2^(n + 1) / (n + 1). Each of two comparisons with the
    /// fastest needs 40, which eight repetitions give; each of three pairs needs 120, which ten give.
    #[test]
    fn a_schedule_is_left_out_once_another_is_faster() {
        let [fast, close, slow] = [1.0, 1.01, 2.0].map(|own| [own; 10]);
        let cells: &[Vec<&str>] = &[vec!["fast", "close", "slow"]];
        let open = |count: usize, goal: Goal| {
            let all = noted(&[("fast", &fast[..count]), ("close", &close[..count]), ("slow", &slow[..count])]);
            all.open_schedules(cells, goal).concat()
        };
        assert_eq!(open(7, Goal::Fastest), [true; 3]);
        assert_eq!(open(8, Goal::Fastest), [false; 3], "the only one that is left needs no more repetitions");
        assert_eq!((open(9, Goal::Order), open(10, Goal::Order)), (vec![true; 3], vec![false; 3]));
    }

    /// The two fast schedules are faster in turns, so only the third is left out. A failed schedule and an image's only
    /// schedule are not repeated.
    #[test]
    fn schedules_that_take_turns_stay() {
        let turns = |first: usize| -> Vec<f64> { (0..20).map(|at| [1.0, 1.1][(at + first) % 2]).collect() };
        let (a, b, slow, failed) = (turns(0), turns(1), vec![3.0; 20], vec![f64::NAN; 20]);
        let all = noted(&[("a", &a), ("b", &b), ("slow", &slow), ("failed", &failed), ("alone", &slow)]);
        let images = [vec!["a", "slow", "failed", "b"], vec!["alone"], vec!["failed", "alone"]];
        for goal in [Goal::Fastest, Goal::Order] {
            let open = all.open_schedules(&images, goal);
            assert_eq!(open, [vec![true, false, false, true], vec![false], vec![false; 2]], "{goal:?}");
        }
    }

    /// Two seeds with three processes each are six processes, in whatever process the values were measured.
    #[test]
    fn seeds_are_processes() {
        let ratios = [1.0, 1.1, 1.3, 0.9, 1.2, 1.05];
        let (own, other) = ([1.0; 3], [1.0; 6]);
        let decisions = noted(&[
            ("a1", &ratios[..3]),
            ("b1", &own),
            ("a2", &ratios[3..]),
            ("b2", &own),
            ("a", &ratios),
            ("b", &other),
        ]);
        let over_seeds = decisions.paired(&[("a1", "b1"), ("a2", "b2")], u32::MAX).unwrap();
        assert_eq!(over_seeds, decisions.paired(&[("a", "b")], u32::MAX).unwrap());
        assert_eq!(over_seeds.processes, 6);
        assert_eq!(decisions.paired(&[("a1", "b1"), ("a2", "b2")], 2).unwrap().processes, 4);
        assert_eq!(decisions.paired(&[("a1", "b1"), ("absent", "b2")], u32::MAX), None);
    }

    #[test]
    fn goals_have_words() {
        let goal = |text: &str| StoppingRule::parse(text, None).map(|until| until.goal);
        assert_eq!(goal("fastest").unwrap(), Goal::Fastest);
        assert_eq!((goal("order").unwrap(), goal("3 %").unwrap()), (Goal::Order, Goal::Share(0.03)));
        for wrong in ["slowest", "0%", "-1%"] {
            let error = goal(wrong).unwrap_err().to_string();
            assert!(error.contains(wrong) && error.contains("fastest, order"), "{error}");
        }
    }
}
