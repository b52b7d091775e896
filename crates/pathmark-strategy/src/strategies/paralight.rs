//! Paralight: a block of the jobs for each thread of a pool, and whoever is done takes the upper half of the largest that is left.
//!
//! `pathmark render cornell --strategy paralight --threads 4`
//!
//! The crate `paralight` for loops over indices, with its range strategy `WorkStealing`. It is `steal-half:richest` with a pool: a range is one
//! 64-bit word there too, and every change of it one compare-exchange.
//!
//! Cost: threads start once, in the construction and not in the run. A run wakes all of them and waits until all have gone to sleep again;
//! a job is a compare-exchange on the worker's own cache line. A thief looks at everybody's range. A worker that finds none leaves the run,
//! even if a thief is about to have more than it can do.

use paralight::prelude::{
    CpuPinningPolicy, ExactParallelSourceExt, IntoExactParallelSource, ParallelIteratorExt, RangeStrategy, ThreadCount,
    ThreadPool, ThreadPoolBuilder,
};

use crate::{
    Amount, Blueprint, Discipline, Entry, Job, Panics, Start, Stealing, Strategy, StrategyError, Threads, Victim,
    library,
};

const STEALING: Stealing = Stealing { start: Start::Blocks, amount: Amount::Half, victim: Victim::Richest };

pub(super) const ENTRY: Entry = Entry {
    threads: Threads::Library,
    ..Entry::new(
        "paralight",
        "blocks; whoever is done steals half of the largest, in a pool (the crate paralight)",
        Discipline::Stealing(STEALING),
        make,
    )
};

/// Paralight's numbers of jobs and threads have 32 bits.
const MOST: usize = u32::MAX as usize;

fn make(blueprint: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    let &Blueprint { strategy, threads, .. } = blueprint;
    if threads.get() > MOST {
        return Err(StrategyError::TooManyThreads { strategy, threads: threads.get(), most: MOST });
    }
    let builder = ThreadPoolBuilder {
        num_threads: ThreadCount::Count(threads),
        range_strategy: RangeStrategy::WorkStealing,
        cpu_pinning: CpuPinningPolicy::No,
    };
    let pool = library::start(blueprint, threads.get(), || builder.build())?;
    Ok(Box::new(Paralight { strategy, pool }))
}

struct Paralight {
    strategy: &'static str,
    pool: ThreadPool,
}

impl Strategy for Paralight {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        if jobs > MOST {
            return Err(StrategyError::TooManyJobs { strategy: self.strategy, jobs, most: MOST });
        }
        let panics = Panics::default();
        let leaf = |index| panics.attempt(|| job(index));
        (0..jobs).into_par_iter().with_thread_pool(&mut self.pool).for_each(leaf);
        drop(job);
        panics.raise();
        Ok(())
    }
}
