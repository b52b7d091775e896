//! Orx-parallel: a free worker takes the next C jobs from a concurrent iterator.
//!
//! `pathmark render cornell --strategy orx-parallel:8 --threads 4`, in a build with `--features more-pools`; without a
//! number C is 1.
//!
//! The crate `orx-parallel` does not split a loop: all workers pull chunks from one shared iterator, which for a range
//! is a counter. So it hands out jobs like `dynamic`. By default it adapts the chunk size as it learns the cost of
//! jobs, and uses at most as many threads as there are processors; here the user sets both. Its pool is rayon's, whose
//! threads come from the spawner.
//!
//! Cost: threads start once, in the construction and not in the run. A run starts a task for each worker, in a scope of
//! rayon. A chunk costs an atomic addition.

use std::num::NonZeroUsize;

use orx_parallel::{ChunkSize, IntoParIter, Par, Runner};

use super::dynamic;
use super::rayon_pool::Pool;
use crate::{Blueprint, Discipline, Entry, Job, Panics, Strategy, StrategyError};

pub(super) const ENTRY: Entry = Entry {
    parameter: dynamic::ENTRY.parameter,
    ..Entry::new(
        "orx-parallel",
        "a free worker takes the next C jobs from an iterator (orx-parallel:C; C is 1 by default; the crate)",
        dynamic::ENTRY.discipline,
        make,
    )
};

fn make(blueprint: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    let chunk = match blueprint.discipline {
        Discipline::Chunks(rule) => NonZeroUsize::new(rule.parameter),
        _ => None,
    };
    Ok(Box::new(OrxParallel { pool: Pool::new(blueprint)?, chunk: chunk.unwrap_or(NonZeroUsize::MIN) }))
}

struct OrxParallel {
    pool: Pool,
    chunk: NonZeroUsize,
}

impl Strategy for OrxParallel {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let runner = Runner::fixed_with_pool(self.pool.rayon());
        let panics = Panics::default();
        let leaf = |index| panics.attempt(|| job(index));
        (0..jobs).into_par().runner(runner).chunk_size(ChunkSize::Exact(self.chunk)).for_each(leaf);
        drop(job);
        panics.raise();
        Ok(())
    }
}
