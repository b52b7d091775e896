//! Who runs which job, and when.
//!
//! A strategy schedules integers: it is given a number of jobs and a function of the job's index, and never learns what a job
//! does. So every strategy can be compared on every workload, and tested without one ([`contract`]).
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
//! * **Workers.** Jobs run on exactly the workers that were asked for. The calling thread only waits, so p threads mean p
//!   workers and p jobs at a time. `serial` alone uses the calling thread, because it is the baseline that pays for nothing.
//!   A strategy that starts its threads for each run starts no more of them than there are jobs.
//! * **A worker that can't be started** makes the whole run (or the construction) an error. Going on with fewer workers would
//!   put a time in the records that belongs to another number of threads.
//! * **A panic** stops every worker after the job it is in; then the first payload is raised again in the caller. The strategy
//!   can be used again.
//!
//! [`contract::verify`] tries all of this on any [`Entry`].
//!
//! # Adding one
//!
//! A strategy is an [`Entry`]. One of your own stays in your crate; one of ours is a file in `src/strategies` and its line in the table there.
//! [`Host`] and [`Panics`] are what most strategies on a library's pool need.

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
pub use entry::{Entry, Parameter, Sharing, Threads, Workers};
pub use error::StrategyError;
pub use host::Host;
pub use ledger::{Clock, LearnedRule, Ledger, Seen, Weights};
pub use panics::Panics;
pub use strategies::{STRATEGIES, block, find};

/// What there is to run: a function of the job's index. Owned, so that workers may have been there before it.
pub type Job = Arc<dyn Fn(usize) + Send + Sync>;

/// A way to spread jobs over workers.
pub trait Strategy: Send {
    /// Calls `job(i)` exactly once for each `i` in `0..jobs` and returns when all have returned.
    /// A panic in a job is re-raised here after the other workers have stopped.
    ///
    /// After an error or a panic some jobs have not been run; none has been run twice. In every case no clone of `job` is left.
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError>;
}
