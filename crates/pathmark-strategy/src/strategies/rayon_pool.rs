//! The pool of a strategy on rayon: each strategy has its own, whose threads come from the spawner.

use std::io;

use ::rayon::{ThreadPool, ThreadPoolBuilder, max_num_threads};

use crate::panics::Panics;
use crate::team::Crew;
use crate::{Blueprint, StrategyError};

/// A pool and its threads. Fields are dropped in this order: dropping the pool ends the threads without waiting for
/// them, then the crew joins them.
pub(super) struct Pool {
    pool: ThreadPool,
    _crew: Crew,
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

    /// Runs `body` on a worker while the caller waits, and raises again a panic that it has caught. Rayon alone would
    /// pass a panic on, too, but would first run all other jobs.
    pub(super) fn run(&self, body: impl FnOnce(&Panics) + Send) {
        let panics = Panics::default();
        self.pool.install(|| body(&panics));
        panics.raise();
    }

    /// Returns rayon's pool.
    #[cfg(feature = "more-pools")]
    pub(super) fn rayon(&self) -> &ThreadPool {
        &self.pool
    }
}
