//! Rayon: a parallel iterator over the jobs, split down to single ones.
//!
//! `pathmark render cornell --strategy rayon --threads 4`
//!
//! The library that most Rust programs use, as they use it. The range of jobs is halved again and again by `join`, whose second half may be
//! stolen (the scheme of Cilk: Blumofe and Leiserson, JACM 46(5), 1999).
//!
//! Cost: threads start once, in the construction and not in the run. A run wakes the pool; a job is a leaf of the tree of joins
//! and costs about one push and pop on the worker's own deque. Idle workers search for a while before they sleep.

use ::rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

use super::rayon_pool::Pool;
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
    Ok(Box::new(Rayon(Pool::new(config, &ENTRY)?)))
}

struct Rayon(Pool);

impl Strategy for Rayon {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        self.0.run(|panics| {
            let leaf = |index| panics.attempt(|| job(index));
            (0..jobs).into_par_iter().with_max_len(1).for_each(leaf);
        });
        Ok(())
    }
}
