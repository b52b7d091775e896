//! Work stealing: each worker has its own queue, and a worker whose queue is empty steals jobs from elsewhere.
//!
//! `pathmark render cornell --strategy work-stealing --threads 4`
//!
//! Blumofe and Leiserson, "Scheduling multithreaded computations by work stealing", JACM 46(5), 1999; the queues are
//! the deques of Chase and Lev, "Dynamic circular work-stealing deque", SPAA 2005, as implemented by `crossbeam-deque`.
//! All jobs start in one shared injector. A worker takes its next job from its own deque, else a batch from the
//! injector, else half of another worker's deque, asking its neighbours in turn.
//!
//! Cost: one thread start for each worker, a push into the injector for each job before that, then mostly operations on
//! the worker's own cache lines. A worker touches the cache lines of others once for each batch.

use std::iter;
use std::sync::Arc;

use crossbeam::deque::{Injector, Steal, Stealer, Worker};

use crate::panics::Panics;
use crate::taken::Taken;
use crate::{Amount, Blueprint, Discipline, Entry, Job, Start, Stealing, StrategyError, Victim, each_run, team};

pub(super) const ENTRY: Entry = Entry::new(
    "work-stealing",
    "a deque for each worker; an idle worker steals from the others",
    Discipline::Stealing(STEALING),
    |blueprint| each_run(blueprint, run),
);

/// Crossbeam moves half of a queue at a time, up to 32 jobs.
const STEALING: Stealing = Stealing { start: Start::Shared(32), amount: Amount::Half, victim: Victim::Neighbour };

fn run(blueprint: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let deques: Vec<_> = (0..blueprint.workers(jobs)).map(|_| Worker::new_lifo()).collect();
    let shared = Arc::new(Shared {
        injector: Injector::new(),
        stealers: deques.iter().map(Worker::stealer).collect(),
        taken: Taken::new(jobs, deques.len()),
    });
    (0..jobs).for_each(|index| shared.injector.push(index));
    let bodies = deques.into_iter().enumerate().map(|(worker, deque)| {
        let (job, shared) = (Arc::clone(job), Arc::clone(&shared));
        move |panics: &Panics| {
            let next = || deque.pop().or_else(|| shared.steal(worker, &deque));
            shared.taken.work(worker, panics, next, &*job);
        }
    });
    team::run(&*blueprint.spawner, bodies)
}

/// The data that the workers of one run share.
struct Shared {
    injector: Injector<usize>,
    stealers: Box<[Stealer<usize>]>,
    taken: Taken,
}

impl Shared {
    /// Steals a batch from the injector or another deque and returns one of its jobs. The others go into `deque`, where
    /// other workers can steal them while this worker is busy.
    fn steal(&self, thief: usize, deque: &Worker<usize>) -> Option<usize> {
        let (before, after) = self.stealers.split_at(thief);
        let victims = after.iter().skip(1).chain(before).map(|victim| victim.steal_batch_and_pop(deque));
        iter::once_with(|| self.injector.steal_batch_and_pop(deque)).chain(victims).find_map(Steal::success)
    }
}
