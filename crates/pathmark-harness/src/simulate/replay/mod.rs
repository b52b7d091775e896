//! Replays: jobs of known costs on virtual workers, from event to event.
//!
//! Each family of disciplines has a file. All of them are exact in the model: a free worker asks at once, hand-outs
//! take the times in [`Overhead`], and ties go to the worker with the lower number. Only noise and the choice of random
//! victims are random, with seeds. A replay costs O(log P) per job, apart from the interruptions of noise.

mod all_at_once;
mod chunks;
mod crew;
mod halving;
mod learned;
mod stealing;

#[cfg(test)]
mod closed_forms;
#[cfg(test)]
mod guarantees;

use super::hardware::Hardware;
use super::overhead::Overhead;
use crate::measure::Trace;
use crate::strategy::Discipline;
use crew::Crew;

/// The result of a replay.
#[derive(Debug, Clone, PartialEq)]
pub struct Replay {
    /// Seconds from handing over the jobs until all are done.
    pub makespan_s: f64,
    /// Which worker ran which job when, in the form of a measured run. Under [`Discipline::AllAtOnce`] a worker is a
    /// thread, and its span contains the time in which other threads had the processor.
    pub trace: Trace,
}

/// Replays jobs of these costs (seconds of a processor of speed 1, in index order) on `workers` workers, each with its
/// own processor. Under [`Discipline::AllAtOnce`], `workers` is the number of processors that the threads share.
pub fn replay(
    costs: &[f64],
    discipline: Discipline,
    workers: usize,
    overhead: &Overhead,
    hardware: &Hardware,
) -> Replay {
    if let Discipline::AllAtOnce = discipline {
        return all_at_once::replay(costs, workers.max(1), overhead, hardware);
    }
    let workers = match discipline {
        Discipline::InOrder => 1,
        // Strategies start at most as many workers as there are jobs.
        _ => workers.clamp(1, costs.len().max(1)),
    };
    let mut crew = Crew::new(costs, workers, overhead, hardware);
    match discipline {
        Discipline::InOrder | Discipline::AllAtOnce => dealt(&mut crew, |_, _, jobs| (0..jobs).step_by(1)),
        Discipline::Dealt(deal) => dealt(&mut crew, deal),
        Discipline::Chunks(rule) => chunks::run(&mut crew, rule),
        Discipline::Learned(rule) => learned::run(&mut crew, rule),
        Discipline::Stealing(stealing) => stealing::run(&mut crew, stealing),
        Discipline::Halving => halving::run(&mut crew),
    }
    crew.into_replay()
}

fn dealt(crew: &mut Crew<'_>, deal: crate::strategy::Deal) {
    let (workers, jobs) = (crew.workers(), crew.jobs());
    while let Some((worker, now_s)) = crew.next_free() {
        crew.work(worker, deal(worker, workers, jobs), now_s);
    }
}
