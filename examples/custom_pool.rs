//! A custom thread pool beside Pathmark's: `paralight` with fixed ranges, which gives each thread a block of the jobs.
//!
//! `cargo run --release --example custom_pool -- render cornell --strategy paralight-fixed --threads 2` renders with it,
//! `-- run thread-scaling` compares it, and `cargo test --example custom_pool` says whether it keeps the contract.

use std::iter::StepBy;
use std::ops::Range;
use std::process::ExitCode;

use paralight::prelude::{
    CpuPinningPolicy, ExactParallelSourceExt, IntoExactParallelSource, ParallelIteratorExt, RangeStrategy, ThreadCount,
    ThreadPool, ThreadPoolBuilder,
};
use pathmark::Lab;
use pathmark::strategy::{Blueprint, Discipline, Entry, Job, Panics, Strategy, StrategyError, Threads, library};

const ENTRY: Entry = Entry {
    threads: Threads::Library, // Paralight starts them itself; a pool that takes threads gets them from `Blueprint::spawner`.
    ..Entry::new(
        "paralight-fixed",
        "a block of jobs for each thread of paralight's pool",
        Discipline::Dealt(deal),
        make,
    )
};

/// Paralight's assignment of jobs, for replay by the simulator. `Discipline::ONE_BY_ONE` and `Halving` describe many
/// other pools.
fn deal(worker: usize, workers: usize, jobs: usize) -> StepBy<Range<usize>> {
    let start = |worker| worker * jobs / workers;
    (start(worker)..start(worker + 1)).step_by(1)
}

fn make(blueprint: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    let threads = blueprint.threads;
    let pool = ThreadPoolBuilder {
        num_threads: ThreadCount::Count(threads),
        range_strategy: RangeStrategy::Fixed,
        cpu_pinning: CpuPinningPolicy::No,
    };
    // If the system refuses a thread, paralight panics; `library::start` turns the panic into an error.
    Ok(Box::new(Fixed(library::start(blueprint, threads.get(), || pool.build())?)))
}

struct Fixed(ThreadPool);

impl Strategy for Fixed {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let panics = Panics::default();
        // After a panic `attempt` skips the remaining jobs, and `raise` passes the panic on.
        let attempt = |index| panics.attempt(|| job(index));
        (0..jobs).into_par_iter().with_thread_pool(&mut self.0).for_each(attempt);
        drop(job);
        panics.raise();
        Ok(())
    }
}

fn main() -> ExitCode {
    pathmark::main(Lab::new().strategy(ENTRY))
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_keeps_the_contract() {
        pathmark::strategy::contract::verify(&super::ENTRY).unwrap();
    }
}
