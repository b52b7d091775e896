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

use super::locked_queue::LockedQueue;
use super::panics::Panics;
use super::{
    Config, Discipline, Entry, Job, Sharing, Strategy, StrategyError, Threads, Workers, self_scheduling, team,
    unless_set,
};

pub(super) const ENTRY: Entry = Entry {
    name: "mutex-queue",
    about: "whoever is free takes the next index from a queue behind one lock",
    workers: Workers::Threads,
    threads: Threads::Spawner,
    sharing: Sharing::AtOnce,
    discipline,
    new,
};

fn discipline(parameter: Option<&str>) -> Result<Discipline, StrategyError> {
    unless_set(ENTRY.name, parameter, self_scheduling::rule(|_| 1))
}

fn new(config: Config) -> Result<Box<dyn Strategy>, StrategyError> {
    config.discipline(&ENTRY)?;
    Ok(Box::new(MutexQueue(config)))
}

struct MutexQueue(Config);

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
