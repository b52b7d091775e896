//! The second stage of a sweep: more processes for the comparisons that missed their precision.
//!
//! A profile asks for it by `repetitions = { at-least = 16, at-most = 48, max-time = "2min" }`. All cells run in the
//! first stage. Its spread tells how many processes each comparison needs (C. Stein, "A two-sample test for a linear
//! hypothesis whose power is independent of the variance", 1945). Only the spread decides, and only once. Unlike Stein's
//! intervals, those over both stages use the spread of all processes; by simulation they keep their level to within 1.4 %.
//! Resumed after `max-time` has ended it, the second stage goes on.

use super::Progress;
use super::running::Running;
use super::stopping_rule::{Decisions, half_width, parse_max_time};
use super::sweep::Sweep;
use crate::analysis::adjacent_pairs::FEWEST_PROCESSES;
use crate::error::{InputError, Result};
use std::time::{Duration, Instant};

/// The share of further processes beyond those that the first stage's spread asks for: the spread is itself uncertain,
/// and without them half of the comparisons would miss their precision again.
const RESERVE: f64 = 0.5;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct SecondStage {
    /// The largest number of processes, over both stages.
    pub(super) at_most: u32,
    /// The time after which no process begins, from the start of the first stage.
    max_time: Option<Duration>,
}

impl SecondStage {
    pub(super) fn parse(at_least: u32, at_most: u32, max_time: Option<&str>) -> Result<Self> {
        let error = |name: &str, value: u32, allowed: String| {
            Err(InputError::new(name, value.to_string(), "is out of range").allowed(allowed).into())
        };
        if at_least < FEWEST_PROCESSES as u32 {
            return error("at-least", at_least, format!("{FEWEST_PROCESSES} or more, which have a spread"));
        }
        if at_most <= at_least {
            return error("at-most", at_most, format!("more than at-least = {at_least}"));
        }
        Ok(Self { at_most, max_time: max_time.map(parse_max_time).transpose()? })
    }
}

/// The processes that a comparison needs for each seed, from those of its first stage; `None` if these suffice or tell nothing.
fn needed(decisions: &Decisions, seeds: &[(&str, &str)], goal: f64, first: u32) -> Option<u32> {
    let found = decisions.paired(seeds, first)?;
    let times_goal = half_width(&found) / goal;
    let missing = times_goal * times_goal - 1.0;
    (missing > 0.0).then(|| (f64::from(first) * (1.0 + (1.0 + RESERVE) * missing)).ceil() as u32)
}

impl Sweep<'_> {
    /// The second stage of the definition. A command that sets repetitions, and a comparison of two builds, have none.
    pub(super) fn second_stage(&self) -> Result<Option<&SecondStage>> {
        let applies = !self.options.say_how_often() && self.options.baseline.is_none();
        Ok(self.definition.second_stage(self.options.profile)?.filter(|_| applies))
    }

    /// Runs the processes of the second stage, in turns like those of the first one.
    pub(super) fn run_second_stage(
        &self,
        stage: &SecondStage,
        (first, begun): (u32, Instant),
        running: &mut Running<'_>,
        progress: &dyn Progress,
    ) -> Result<()> {
        let mut wanted = vec![first; self.cells.len()];
        let mut missed = 0;
        for seeds in self.comparisons.over_seeds(&self.cells) {
            let cells: Vec<usize> = seeds.iter().flat_map(|pair| [pair.what, pair.with]).collect();
            let id = |index: usize| self.cells[index].id.as_str();
            let ids: Vec<(&str, &str)> = seeds.iter().map(|pair| (id(pair.what), id(pair.with))).collect();
            // A cell of fewer repetitions than the profile's has them by its matrix.
            let is_limited = cells.iter().any(|index| self.cells[*index].at_most.is_some());
            let goal = seeds[0].goal.filter(|_| !is_limited);
            let Some(needed) = goal.and_then(|goal| needed(running.decisions(), &ids, goal, first)) else { continue };
            missed += 1;
            for index in cells {
                wanted[index] = wanted[index].max(needed.min(stage.at_most));
            }
        }
        let total: u64 =
            self.cells.iter().zip(&wanted).map(|(cell, wanted)| cell.weight * u64::from(wanted - first)).sum();
        let is_over = || stage.max_time.is_some_and(|most| begun.elapsed() >= most);
        if missed == 0 || is_over() {
            return Ok(());
        }
        progress.note(&format!("{missed} comparisons missed their precision in {first} processes and get more"));
        progress.begin(&format!("{}, more processes", self.definition.name), total);
        let (groups, mut done) = (self.comparisons.groups(self.cells.len()), 0);
        for process in first..stage.at_most {
            for group in &groups {
                let open: Vec<usize> = group.iter().copied().filter(|index| wanted[*index] > process).collect();
                if open.is_empty() || is_over() {
                    continue;
                }
                running.side_by_side(&open, process)?;
                done += open.iter().map(|index| self.cells[*index].weight).sum::<u64>();
                progress.advance(done);
            }
        }
        progress.end();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Record;
    use rand::Rng;
    use rand_pcg::Pcg64Dxsm;

    /// Sweeps of one comparison, whose ratio is 1 and scatters between processes by `deviation`: the share of sweeps whose
    /// interval holds the ratio, the share whose interval is as narrow as the goal, and the mean number of processes.
    fn sweeps(count: u32, deviation: f64, goal: f64) -> [f64; 3] {
        let mut generator = Pcg64Dxsm::new(7, 11);
        let mut uniform = move || ((generator.next_u64() >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0;
        let mut normal = || (-2.0 * libm::log(uniform())).sqrt() * libm::cos(std::f64::consts::TAU * uniform());
        let mut sums = [0.0; 3];
        for _ in 0..count {
            let mut decisions = Decisions::default();
            let mut run = |decisions: &mut Decisions, processes: std::ops::Range<u32>| {
                for repetition in processes {
                    let ratio = libm::exp(deviation * normal());
                    for (cell, time) in [("what", ratio), ("with", 1.0)] {
                        let (cell, makespan_s) = (cell.to_string(), Some(time));
                        let row = Record { cell, repetition, makespan_s, pair: Some(0), ..Record::default() };
                        decisions.note(&row, true);
                    }
                }
            };
            run(&mut decisions, 0..16);
            let processes = needed(&decisions, &[("what", "with")], goal, 16).map_or(16, |needed| needed.min(200));
            run(&mut decisions, 16..processes);
            let found = decisions.paired(&[("what", "with")], u32::MAX).unwrap();
            sums[0] += f64::from(found.ratio.interval.low <= 1.0 && 1.0 <= found.ratio.interval.high);
            sums[1] += f64::from(half_width(&found) <= goal);
            sums[2] += f64::from(processes);
        }
        sums.map(|sum| sum / f64::from(count))
    }

    /// 4000 sweeps: the share that holds the ratio has a standard deviation of .35 %. A spread of 3 % needs some 42
    /// processes for +-1 %, and one of 1 % needs no more than the first stage.
    #[test]
    fn intervals_over_both_stages_cover_and_reach_the_goal() {
        let [covered, reached, processes] = sweeps(4000, 0.03, 0.01);
        assert!((0.936..=0.964).contains(&covered), "{covered}");
        assert!(reached > 0.85 && (45.0..70.0).contains(&processes), "{reached} {processes}");
        let [covered, reached, processes] = sweeps(4000, 0.01, 0.01);
        assert!((0.936..=0.964).contains(&covered) && reached > 0.99 && processes < 16.1, "{covered} {processes}");
    }

    #[test]
    fn wrong_numbers_are_refused() {
        let error = |least, most| SecondStage::parse(least, most, None).unwrap_err().to_string();
        assert!(error(16, 16).contains("more than at-least = 16"), "{}", error(16, 16));
        assert!(error(2, 16).contains("3 or more"), "{}", error(2, 16));
        assert!(SecondStage::parse(16, 17, Some("ages")).is_err());
    }
}
