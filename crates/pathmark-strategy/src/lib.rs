//! Scheduling strategies: which worker runs which job, and when.
//!
//! A strategy schedules integers: it receives a number of jobs and a function of the job's index, and knows nothing
//! else about a job. So every strategy can be compared on every workload, and tested without a workload ([`contract`]).
//!
//! ```
//! use std::num::NonZeroUsize;
//! use std::sync::Arc;
//! use std::sync::atomic::{AtomicUsize, Ordering};
//! use pathmark_strategy::{Config, find};
//!
//! let entry = find("shared-counter").expect("it is in the table");
//! let mut strategy = entry.build(Config::new(NonZeroUsize::MIN))?;
//! let sum = Arc::new(AtomicUsize::new(0));
//! let total = Arc::clone(&sum);
//! strategy.run(10, Arc::new(move |index| { total.fetch_add(index, Ordering::Relaxed); }))?;
//! assert_eq!(sum.load(Ordering::Relaxed), 45);
//! # Ok::<(), pathmark_strategy::StrategyError>(())
//! ```
//!
//! # What all strategies share
//!
//! * **Workers.** Jobs run on exactly the requested number of workers. The calling thread only waits, so p threads mean
//!   p workers and p jobs at a time. Only `serial` uses the calling thread, because it is the baseline without any
//!   overhead. A strategy that starts its threads in each run starts at most one thread for each job.
//! * **A worker that can't be started** makes the whole run (or the construction) an error. With fewer workers the
//!   run's time would be recorded under a wrong number of threads.
//! * **A panic** stops every worker after its current job; then the first payload is raised again in the caller. The
//!   strategy can be used again.
//!
//! [`contract::verify`] tests all of this on any [`Entry`].
//!
//! # Adding a strategy
//!
//! A strategy is an [`Entry`]. Your own strategies stay in your crate. A built-in strategy is a file in
//! `src/strategies` and its line in the table there. Most strategies on a library's pool need [`Host`] and [`Panics`].

pub mod contract;
pub mod library;

mod config;
mod counter;
mod dealt;
mod discipline;
mod entry;
mod error;
mod host;
mod learning;
mod ledger;
mod locked_queue;
mod panics;
mod ranges;
mod self_scheduling;
mod strategies;
mod sync;
mod taken;
mod team;

use std::sync::Arc;

pub use config::{Blueprint, Config, Spawner, SystemThreads};
pub use discipline::{Amount, ChunkRule, Deal, Discipline, Handout, Start, Stealing, Victim};
pub use entry::{Entry, Parameter, Run, Sharing, Threads, Workers, each_run};
pub use error::StrategyError;
pub use host::Host;
pub use ledger::{Clock, LearnedRule, Ledger, Seen, Weights};
pub use panics::Panics;
pub use strategies::{LEFT_OUT, STRATEGIES, block, find};

/// The work of a run: a function of the job's index. It is owned, so that workers may exist before it.
pub type Job = Arc<dyn Fn(usize) + Send + Sync>;

/// A way to spread jobs over workers.
pub trait Strategy: Send {
    /// Calls `job(i)` exactly once for each `i` in `0..jobs` and returns when all have returned.
    /// A panic in a job is re-raised here after the other workers have stopped.
    ///
    /// After an error or a panic, some jobs may not have run, and no job has run twice. No clone of `job` is left in
    /// any case.
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError>;
}
