//! Disciplines: how a strategy hands out jobs, without the threads, queues and locks behind it.
//!
//! A strategy's [`Discipline`] is pure data and pure functions, so the simulator can replay it with more workers than
//! this machine has. Where possible, the strategy itself calls the same functions; then both agree by construction.

use crate::ledger::LearnedRule;
use std::iter::StepBy;
use std::ops::Range;

/// The rule by which workers get their jobs.
#[derive(Debug, Clone, Copy)]
pub enum Discipline {
    /// One worker takes the jobs in order.
    InOrder,
    /// Each job has its own thread. Threads start in order, and the operating system shares the processors among them.
    AllAtOnce,
    /// Each worker's jobs are fixed beforehand.
    Dealt(Deal),
    /// A free worker takes the next chunk of jobs from one place that all workers share.
    Chunks(ChunkRule),
    /// A free worker takes the next chunk of jobs, whose size depends on the measured speeds of the workers.
    Learned(LearnedRule),
    /// A free worker takes jobs from its own queue, or from another worker's queue if its own is empty.
    Stealing(Stealing),
    /// The range of jobs is halved again and again. A worker continues with the first half; a free worker takes the
    /// largest second half that waits anywhere.
    Halving,
}

impl Discipline {
    /// A free worker takes the next job.
    pub const ONE_BY_ONE: Self = Self::Chunks(ChunkRule { size: |_| 1, parameter: 1 });
}

/// A function that returns the jobs of `worker` out of `workers`. Each job in `0..jobs` belongs to exactly one worker.
/// `workers` is at least 1.
pub type Deal = fn(worker: usize, workers: usize, jobs: usize) -> StepBy<Range<usize>>;

/// The rule for the size of the chunk that a free worker takes from the shared range of jobs.
#[derive(Debug, Clone, Copy)]
pub struct ChunkRule {
    /// Number of jobs in the next chunk. [`ChunkRule::next`] clamps it to at least 1 and at most the number of jobs
    /// left.
    pub size: fn(&Handout) -> usize,
    /// The number that the user may set, for rules that have one.
    pub parameter: usize,
}

/// The progress of handing out the jobs of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Handout {
    /// Total number of jobs.
    pub jobs: usize,
    /// Number of workers, at least 1.
    pub workers: usize,
    /// Jobs that have been handed out.
    pub start: usize,
    /// Chunks that have been handed out.
    pub chunks: usize,
    /// The rule's parameter.
    pub parameter: usize,
}

impl ChunkRule {
    /// Returns the next chunk, or `None` when all jobs have been handed out.
    pub fn next(&self, handout: &mut Handout) -> Option<Range<usize>> {
        let left = handout.jobs - handout.start;
        if left == 0 {
            return None;
        }
        let size = (self.size)(handout).clamp(1, left);
        let chunk = handout.start..handout.start + size;
        handout.start = chunk.end;
        handout.chunks += 1;
        Some(chunk)
    }

    /// Returns all chunks in the order in which they are taken.
    pub fn chunks(self, jobs: usize, workers: usize) -> impl Iterator<Item = Range<usize>> {
        let mut handout = Handout { jobs, workers, start: 0, chunks: 0, parameter: self.parameter };
        std::iter::from_fn(move || self.next(&mut handout))
    }
}

/// The details of a stealing discipline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stealing {
    /// Where the jobs are at the beginning of a run.
    pub start: Start,
    /// Number of jobs that a thief takes.
    pub amount: Amount,
    /// The worker that a thief takes them from.
    pub victim: Victim,
}

/// Where the jobs are at the beginning of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// Each worker has one contiguous block of jobs.
    Blocks,
    /// All jobs are in one shared queue. A worker takes half of the queue at a time, up to this many jobs.
    Shared(usize),
}

/// Number of jobs that a thief takes from its victim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Amount {
    /// One job.
    One,
    /// Half of the victim's remaining jobs, rounded up.
    Half,
}

/// The worker that a thief steals from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Victim {
    /// The next worker that has jobs, counted upwards from the thief.
    Neighbour,
    /// The first worker that has jobs, counted upwards from a random worker.
    Random,
    /// The worker that has the most jobs.
    Richest,
}
