//! Self-scheduling: a free worker takes the next chunk from one list, whose sizes follow a [`ChunkRule`].
//!
//! The sizes depend only on the numbers of jobs and workers, not on the order of requests. So the list is made before
//! the workers start, and taking a chunk is one atomic addition under every rule.

use std::sync::Arc;

use crate::counter::Counter;
use crate::panics::Panics;
use crate::{Blueprint, ChunkRule, Discipline, Job, Strategy, StrategyError, team};

/// Makes a strategy whose discipline is a chunk rule.
pub(crate) fn make(blueprint: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    match blueprint.discipline {
        Discipline::Chunks(rule) => Ok(Box::new(SelfScheduling { blueprint: blueprint.clone(), rule })),
        other => unreachable!("{} hands out jobs by {other:?}", blueprint.strategy),
    }
}

struct SelfScheduling {
    blueprint: Blueprint,
    rule: ChunkRule,
}

impl Strategy for SelfScheduling {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let workers = self.blueprint.threads.get().min(jobs);
        let chunks: Arc<[_]> = self.rule.chunks(jobs, workers).collect();
        let next = Arc::new(Counter::default());
        let bodies = (0..workers).map(|_| {
            let (job, next, chunks) = (Arc::clone(&job), Arc::clone(&next), Arc::clone(&chunks));
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
        team::run(&*self.blueprint.spawner, bodies)
    }
}

#[cfg(test)]
mod tests {
    use crate::{Discipline, STRATEGIES};

    /// Every chunk rule hands out each job once, for any numbers of jobs and workers.
    #[test]
    fn chunks_join_up_and_cover_all_jobs() {
        let rules = STRATEGIES.iter().filter_map(|entry| match entry.discipline {
            Discipline::Chunks(rule) => Some((entry.name, rule)),
            _ => None,
        });
        for (name, rule) in rules {
            for jobs in [0, 1, 2, 7, 100, 1000, 20_000] {
                for workers in [1, 2, 3, 8, 768] {
                    let mut end = 0;
                    for chunk in rule.chunks(jobs, workers) {
                        assert!(chunk.start == end && chunk.end > end, "{name}: {chunk:?} after {end}");
                        end = chunk.end;
                    }
                    assert_eq!(end, jobs, "{name}, {workers} workers");
                }
            }
        }
    }
}
