//! Mutex queue: whoever is free takes the next index from a queue behind one lock.
//!
//! `pathmark render cornell --strategy mutex-queue --threads 4`
//!
//! The task queue as it is first taught, with the central queue of Tang and Yew, "Processor self-scheduling for multiple-nested parallel
//! loops", ICPP 1986, and nothing clever. What it adds to `shared-counter` is what a lock costs.
//!
//! Cost: one thread's start for each worker, memory for all indices, and a lock and an unlock for each job. Workers that meet at the lock
//! sleep and are woken by the system, which small jobs make the rule.

use std::sync::Arc;

use crate::locked_queue::LockedQueue;
use crate::panics::Panics;
use crate::{Blueprint, Discipline, Entry, Job, Strategy, StrategyError, team};

pub(super) const ENTRY: Entry = Entry::new(
    "mutex-queue",
    "whoever is free takes the next index from a queue behind one lock",
    Discipline::ONE_BY_ONE,
    make,
);

fn make(blueprint: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    Ok(Box::new(MutexQueue(blueprint.clone())))
}

struct MutexQueue(Blueprint);

impl Strategy for MutexQueue {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let queue = Arc::new(LockedQueue::new(jobs));
        let bodies = (0..self.0.threads.get().min(jobs)).map(|_| {
            let (job, queue) = (Arc::clone(&job), Arc::clone(&queue));
            move |panics: &Panics| {
                while !panics.stop_asked() {
                    let Some(index) = queue.take() else { break };
                    job(index);
                }
            }
        });
        team::run(&*self.0.spawner, bodies)
    }
}
