//! Paralight: a block of jobs for each thread of a pool; an idle thread takes the upper half of the largest block left.
//!
//! `pathmark render cornell --strategy paralight --threads 4`
//!
//! The crate `paralight` for loops over indices, with its range strategy `WorkStealing`. It is `steal-half:richest`
//! with a pool: its ranges, too, are 64-bit words, and every change is one compare-exchange.
//!
//! Cost: threads start once, in the construction and not in the run. A run wakes all of them and waits until all sleep
//! again. A job costs a compare-exchange on the worker's own cache line. A thief looks at every worker's range. A
//! worker that finds no job leaves the run, even if a thief is about to have more jobs than it can do.

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
        "blocks; an idle worker steals half of the largest, in a pool (the crate paralight)",
        Discipline::Stealing(STEALING),
        make,
    )
};

/// Largest number of jobs and of threads, which have 32 bits in paralight.
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
