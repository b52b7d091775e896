//! Self-scheduling: a free worker takes the next chunk from one list, whose sizes follow a [`ChunkRule`].
//!
//! The sizes depend only on the numbers of jobs and workers, not on the order of requests. So the list is made before
//! the workers start, and taking a chunk is one atomic addition under every rule.

use std::sync::Arc;

use crate::counter::Counter;
use crate::panics::Panics;
use crate::{Blueprint, Discipline, Job, StrategyError, team};

pub(crate) fn run(blueprint: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let Discipline::Chunks(rule) = blueprint.discipline else {
        unreachable!("{} hands out jobs by {:?}", blueprint.strategy, blueprint.discipline)
    };
    let workers = blueprint.workers(jobs);
    let chunks: Arc<[_]> = rule.chunks(jobs, workers).collect();
    let next = Arc::new(Counter::default());
    let bodies = (0..workers).map(|_| {
        let (job, next, chunks) = (Arc::clone(job), Arc::clone(&next), Arc::clone(&chunks));
        move |panics: &Panics| {
            while let Some(chunk) = chunks.get(next.take()) {
                for index in chunk.clone() {
                    if panics.stop_asked() {
                        return;
                    }
                    job(index);
                }
            }
        }
    });
    team::run(&*blueprint.spawner, bodies)
}
