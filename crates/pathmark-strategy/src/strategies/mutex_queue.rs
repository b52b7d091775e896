//! Mutex queue: a free worker takes the next index from a queue behind one lock.
//!
//! `pathmark render cornell --strategy mutex-queue --threads 4`
//!
//! The textbook task queue, with the central queue of Tang and Yew, "Processor self-scheduling for multiple-nested
//! parallel loops", ICPP 1986. Compared with `shared-counter` it shows the cost of a lock.
//!
//! Cost: one thread start for each worker, memory for all indices, and a lock and an unlock for each job. Workers that
//! find the lock taken sleep until the system wakes them; with small jobs that is the rule.

use std::sync::Arc;

use crate::locked_queue::LockedQueue;
use crate::panics::Panics;
use crate::{Blueprint, Discipline, Entry, Job, StrategyError, each_run, team};

pub(super) const ENTRY: Entry = Entry::new(
    "mutex-queue",
    "a free worker takes the next index from a queue behind one lock",
    Discipline::ONE_BY_ONE,
    |blueprint| each_run(blueprint, run),
);

fn run(blueprint: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let queue = Arc::new(LockedQueue::new(jobs));
    let bodies = (0..blueprint.workers(jobs)).map(|_| {
        let (job, queue) = (Arc::clone(job), Arc::clone(&queue));
        move |panics: &Panics| {
            while !panics.stop_asked() {
                let Some(index) = queue.take() else { break };
                job(index);
            }
        }
    });
    team::run(&*blueprint.spawner, bodies)
}
