//! What the strategies on rayon share: a pool of their own, whose threads come from the spawner.

use std::io;

use ::rayon::{ThreadPool, ThreadPoolBuilder, max_num_threads};

use crate::panics::Panics;
use crate::team::Crew;
use crate::{Blueprint, StrategyError};

/// Fields are dropped in this order: the end of the pool is what ends the threads that the crew then waits for, which the pool
/// itself does not do.
pub(super) struct Pool {
    pool: ThreadPool,
    _crew: Crew,
}

impl Pool {
    /// Starts a strategy's pool. It has the size asked for; rayon's global pool, which has the machine's size, is never touched.
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

    /// Runs `body` on a worker while the caller waits, and passes on what it has caught. Rayon alone would pass a panic on too, but run
    /// all other jobs first.
    pub(super) fn run(&self, body: impl FnOnce(&Panics) + Send) {
        let panics = Panics::default();
        self.pool.install(|| body(&panics));
        panics.raise();
    }

    /// The pool itself.
    pub(super) fn rayon(&self) -> &ThreadPool {
        &self.pool
    }
}
