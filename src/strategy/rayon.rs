//! Rayon: a parallel iterator over the jobs, split down to single ones.
//!
//! `pathmark render cornell --strategy rayon --threads 4`
//!
//! The library that most Rust programs use. The range of jobs is halved again and again by `join`, whose second half may be stolen
//! (the scheme of Cilk: Blumofe and Leiserson, JACM 46(5), 1999). The pool is this strategy's own and has the size asked for; the
//! global pool, which has the machine's size, is never touched.
//!
//! Cost: threads start once, in the construction and not in the run. A run wakes the pool; a job is a leaf of the tree of joins
//! and costs about one push and pop on the worker's own deque. Idle workers search for a while before they sleep.

use std::io;

use ::rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use ::rayon::{ThreadPool, ThreadPoolBuilder, max_num_threads};

use super::team::{Crew, Panics};
use super::{Config, Discipline, Entry, Job, Sharing, Strategy, StrategyError, Threads, Workers, unless_set};

pub(super) const ENTRY: Entry = Entry {
    name: "rayon",
    about: "rayon's parallel iterator in a pool of its own, split down to single jobs",
    workers: Workers::Threads,
    threads: Threads::Spawner,
    sharing: Sharing::AtOnce,
    discipline,
    new,
};

fn discipline(parameter: Option<&str>) -> Result<Discipline, StrategyError> {
    unless_set(ENTRY.name, parameter, Discipline::Halving)
}

fn new(config: Config) -> Result<Box<dyn Strategy>, StrategyError> {
    config.discipline(&ENTRY)?;
    let (threads, most) = (config.threads.get(), max_num_threads());
    if threads > most {
        return Err(StrategyError::TooManyThreads { strategy: ENTRY.name, threads, most });
    }
    let mut crew = Crew::default();
    let mut refusal = None;
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads)
        .spawn_handler(|worker| {
            crew.hire(&*config.spawner, threads, || worker.run()).map_err(|error| {
                refusal = Some(error);
                io::Error::from(io::ErrorKind::Other)
            })
        })
        .build();
    match pool {
        Ok(pool) => Ok(Box::new(Rayon { pool, _crew: crew })),
        Err(error) => Err(refusal.unwrap_or_else(|| StrategyError::Spawn {
            worker: crew.len() + 1,
            workers: threads,
            source: io::Error::other(error),
        })),
    }
}

/// Fields are dropped in this order: the end of the pool is what ends the threads that the crew then waits for, which the pool
/// itself does not do.
struct Rayon {
    pool: ThreadPool,
    _crew: Crew,
}

impl Strategy for Rayon {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        // Rayon alone would pass a panic on, but run all other jobs first.
        let panics = Panics::default();
        self.pool.install(|| {
            (0..jobs).into_par_iter().with_max_len(1).for_each(|index| {
                if !panics.stop_asked() {
                    panics.catch(|| job(index));
                }
            });
        });
        panics.raise();
        Ok(())
    }
}
