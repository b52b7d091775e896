//! Shared counter: whoever is free takes the next index from one atomic counter.
//!
//! `pathmark render cornell --strategy shared-counter --threads 4`
//!
//! Processor self-scheduling in its purest form, a chunk of one job: Tang and Yew, "Processor self-scheduling for multiple-nested
//! parallel loops", ICPP 1986. OpenMP calls it `schedule(dynamic, 1)`.
//!
//! Cost: one thread's start for each worker, and for each job one atomic addition on a cache line that all workers want. No
//! worker idles while a job is left, so the imbalance is one job at most; with very small jobs the line is the bottleneck.

use std::sync::Arc;

use super::counter::Counter;
use super::panics::Panics;
use super::self_scheduling;
use super::team;
use super::{Config, Discipline, Entry, Job, Sharing, Strategy, StrategyError, Threads, Workers, unless_set};

pub(super) const ENTRY: Entry = Entry {
    name: "shared-counter",
    about: "whoever is free takes the next index from an atomic counter",
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
    Ok(Box::new(SharedCounter(config)))
}

struct SharedCounter(Config);

impl Strategy for SharedCounter {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let next = Arc::new(Counter::default());
        let bodies = (0..self.0.threads.get().min(jobs)).map(|_| {
            let (job, next) = (Arc::clone(&job), Arc::clone(&next));
            move |panics: &Panics| {
                while !panics.stop_asked() {
                    let index = next.take();
                    if index >= jobs {
                        break;
                    }
                    job(index);
                }
            }
        });
        team::run(&*self.0.spawner, bodies)
    }
}
