//! Shared counter: a free worker takes the next index from one atomic counter.
//!
//! `pathmark render cornell --strategy shared-counter --threads 4`
//!
//! Processor self-scheduling with chunks of one job: Tang and Yew, "Processor self-scheduling for multiple-nested
//! parallel loops", ICPP 1986. OpenMP calls it `schedule(dynamic, 1)`.
//!
//! Cost: one thread start for each worker, and for each job one atomic addition on a cache line that all workers use.
//! No worker idles while a job is left, so the imbalance is at most one job. With very small jobs that cache line is
//! the bottleneck.

use std::sync::Arc;

use crate::counter::Counter;
use crate::panics::Panics;
use crate::{Blueprint, Discipline, Entry, Job, StrategyError, each_run, team};

pub(super) const ENTRY: Entry = Entry::new(
    "shared-counter",
    "a free worker takes the next index from an atomic counter",
    Discipline::ONE_BY_ONE,
    |blueprint| each_run(blueprint, run),
);

fn run(blueprint: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let next = Arc::new(Counter::default());
    let bodies = (0..blueprint.workers(jobs)).map(|_| {
        let (job, next) = (Arc::clone(job), Arc::clone(&next));
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
    team::run(&*blueprint.spawner, bodies)
}
