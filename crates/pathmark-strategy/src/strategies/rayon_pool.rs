//! The pool of a strategy on rayon: each strategy has its own, whose threads come from the spawner.

use std::io;

use ::rayon::{ThreadPool, ThreadPoolBuilder, max_num_threads};

use crate::panics::Panics;
use crate::team::Crew;
use crate::{Blueprint, Job, Strategy, StrategyError};

/// A pool and its threads. Fields are dropped in this order: dropping the pool ends the threads without waiting for
/// them, then the crew joins them.
pub(super) struct Pool {
    pool: ThreadPool,
    _crew: Crew,
}

/// Calls the job once for each index below the number of jobs, on the workers of the pool that calls this.
pub(super) type InPool = fn(&Panics, usize, &Job);

/// Makes a strategy with its own pool, whose runs are a function.
pub(super) fn in_pool(blueprint: &Blueprint, run: InPool) -> Result<Box<dyn Strategy>, StrategyError> {
    Ok(Box::new((Pool::new(blueprint)?, run)))
}

impl Strategy for (Pool, InPool) {
    /// Raises again a panic that a job has caught. Rayon alone would pass a panic on, too, but would first run all other
    /// jobs.
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let (Pool { pool, .. }, run) = self;
        let panics = Panics::default();
        pool.install(|| run(&panics, jobs, &job));
        panics.raise();
        Ok(())
    }
}

impl Pool {
    /// Starts a strategy's pool with the requested size. Rayon's global pool, which has the machine's size, is never
    /// used.
    pub(super) fn new(blueprint: &Blueprint) -> Result<Self, StrategyError> {
        let &Blueprint { strategy, threads, ref spawner, .. } = blueprint;
        let (threads, most) = (threads.get(), max_num_threads());
        if threads > most {
            return Err(StrategyError::TooManyThreads { strategy, threads, most });
        }
        let mut crew = Crew::default();
        let mut refusal = None;
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads)
            .spawn_handler(|worker| {
                crew.hire(&**spawner, threads, || worker.run()).map_err(|error| {
                    refusal = Some(error);
                    io::Error::from(io::ErrorKind::Other)
                })
            })
            .build();
        match pool {
            Ok(pool) => Ok(Self { pool, _crew: crew }),
            Err(error) => Err(refusal.unwrap_or_else(|| StrategyError::Spawn {
                worker: crew.len() + 1,
                workers: threads,
                source: io::Error::other(error),
            })),
        }
    }

    /// Returns rayon's pool.
    #[cfg(feature = "more-pools")]
    pub(super) fn rayon(&self) -> &ThreadPool {
        &self.pool
    }
}
