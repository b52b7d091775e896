//! How a strategy hands out jobs, apart from the threads, queues and locks that it does it with.
//!
//! A strategy's [`Discipline`] is pure data and pure functions, so the simulator can replay it on workers that this machine does not
//! have. The strategy itself is built on the same functions wherever that is possible: both then agree by construction.

use crate::ledger::LearnedRule;
use std::iter::StepBy;
use std::ops::Range;

/// Who gets which job next.
#[derive(Debug, Clone, Copy)]
pub enum Discipline {
    /// One worker takes the jobs in order.
    InOrder,
    /// Every job has a thread of its own, started in order; the operating system shares the processors among them.
    AllAtOnce,
    /// Each worker's jobs are fixed beforehand.
    Dealt(Deal),
    /// A worker that is free takes the next chunk of jobs from one place that all share.
    Chunks(ChunkRule),
    /// A worker that is free takes the next chunk of jobs, whose size depends on how fast the workers have been.
    Learned(LearnedRule),
    /// A worker that is free takes from its own queue, and when that is empty from another's.
    Stealing(Stealing),
    /// The range of jobs is halved again and again; a worker goes on with the first half, and one that is free takes the largest
    /// second half that waits anywhere.
    Halving,
}

impl Discipline {
    /// A worker that is free takes the next job.
    pub const ONE_BY_ONE: Self = Self::Chunks(ChunkRule { size: |_| 1, parameter: 1 });
}

/// The jobs of `worker` out of `workers`; together the workers have each of `0..jobs` once. `workers` is at least 1.
pub type Deal = fn(worker: usize, workers: usize, jobs: usize) -> StepBy<Range<usize>>;

/// How large the chunk is that a free worker takes from the shared range of jobs.
#[derive(Debug, Clone, Copy)]
pub struct ChunkRule {
    /// Jobs in the next chunk. What is less than one or more than what is left is corrected by [`ChunkRule::next`].
    pub size: fn(&Handout) -> usize,
    /// The number that the user may set, for rules that have one.
    pub parameter: usize,
}

/// How far the jobs have been handed out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Handout {
    /// Jobs in all.
    pub jobs: usize,
    /// Workers, at least 1.
    pub workers: usize,
    /// Jobs that have been handed out.
    pub start: usize,
    /// Chunks that have been handed out.
    pub chunks: usize,
    /// The rule's parameter.
    pub parameter: usize,
}

impl ChunkRule {
    /// The next chunk; `None` when all jobs have been handed out.
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

    /// All chunks, in the order in which they are taken.
    pub fn chunks(self, jobs: usize, workers: usize) -> impl Iterator<Item = Range<usize>> {
        let mut handout = Handout { jobs, workers, start: 0, chunks: 0, parameter: self.parameter };
        std::iter::from_fn(move || self.next(&mut handout))
    }
}

/// The details of a stealing discipline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stealing {
    /// Where the jobs are at the beginning.
    pub start: Start,
    /// How much a thief takes.
    pub amount: Amount,
    /// From whom.
    pub victim: Victim,
}

/// Where the jobs are before anyone has worked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// Each worker has one contiguous block of them.
    Blocks,
    /// All are in one shared queue, from which a worker takes half of what is there, up to this many at a time.
    Shared(usize),
}

/// How much a thief takes from its victim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Amount {
    /// One job.
    One,
    /// Half of what the victim has left, rounded up.
    Half,
}

/// Whom a thief asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Victim {
    /// The next worker that has something, counted from the thief.
    Neighbour,
    /// The first one that has something, from a random start.
    Random,
    /// The one that has most.
    Richest,
}
