//! Replays: jobs of known costs on virtual workers, from event to event.
//!
//! All disciplines are exact in the model: a free worker asks at once, hand-outs
//! take the times in [`Overhead`], and ties go to the worker with the lower number. Only the choice of random
//! victims is random, with seeds. A replay costs O(log P) per job.

mod all_at_once;
mod crew;
mod halving;
mod stealing;

#[cfg(test)]
mod closed_form_tests;
#[cfg(test)]
mod guarantee_tests;

use super::hardware::Hardware;
use super::overhead::Overhead;
use crate::measure::Trace;
use crate::strategy::{ChunkRule, Deal, Discipline, Handout, LearnedRule, Ledger};
use crew::Crew;

#[derive(Debug, Clone, PartialEq)]
pub struct Replay {
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
        Discipline::Chunks(rule) => chunks(&mut crew, rule),
        Discipline::Learned(rule) => learned(&mut crew, rule),
        Discipline::Stealing(stealing) => stealing::run(&mut crew, stealing),
        Discipline::Halving => halving::run(&mut crew),
    }
    crew.into_replay()
}

fn dealt(crew: &mut Crew<'_>, deal: Deal) {
    let (workers, jobs) = (crew.workers(), crew.jobs());
    while let Some((worker, now_s)) = crew.next_free() {
        crew.work(worker, deal(worker, workers, jobs), now_s);
    }
}

/// Self-scheduling: a free worker takes the next chunk from the shared place.
fn chunks(crew: &mut Crew<'_>, rule: ChunkRule) {
    let (jobs, workers) = (crew.jobs(), crew.workers());
    let mut handout = Handout { jobs, workers, start: 0, chunks: 0, parameter: rule.parameter };
    while let Some((worker, now_s)) = crew.next_free() {
        match rule.next(&mut handout) {
            Some(chunk) => {
                let got_s = crew.through_shared_place(worker, 1, now_s);
                let free_s = crew.work(worker, chunk, got_s);
                crew.ask_again(worker, free_s);
            }
            None => _ = crew.work(worker, [], now_s),
        }
    }
}

/// Self-scheduling by measured speed: a free worker reports how long its last jobs took, which decides the size of its
/// next chunk.
fn learned(crew: &mut Crew<'_>, rule: LearnedRule) {
    let mut ledger = Ledger::new(crew.jobs(), crew.workers(), rule.weights);
    let mut last = vec![0..0; crew.workers()];
    while let Some((worker, now_s)) = crew.next_free() {
        ledger.note(worker, crew.seen(last[worker].clone()));
        match rule.next(&mut ledger, worker) {
            Some(chunk) => {
                let got_s = crew.through_shared_place(worker, 1, now_s);
                let free_s = crew.work(worker, chunk.clone(), got_s);
                last[worker] = chunk;
                crew.ask_again(worker, free_s);
            }
            None => _ = crew.work(worker, [], now_s),
        }
    }
}
