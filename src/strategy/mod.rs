//! Who runs which job, and when.
//!
//! A strategy schedules integers: it is given a number of jobs and a function of the job's index, and never learns what a job
//! does. So every strategy can be compared on every workload, and tested without one (`tests/strategy_contract`).
//!
//! ```
//! use std::num::NonZeroUsize;
//! use std::sync::Arc;
//! use std::sync::atomic::{AtomicUsize, Ordering};
//! use pathmark::strategy::{Config, find};
//!
//! let entry = find("shared-counter").expect("it is in the table");
//! let mut strategy = (entry.new)(Config::new(NonZeroUsize::MIN))?;
//! let sum = Arc::new(AtomicUsize::new(0));
//! let total = Arc::clone(&sum);
//! strategy.run(10, Arc::new(move |index| { total.fetch_add(index, Ordering::Relaxed); }))?;
//! assert_eq!(sum.load(Ordering::Relaxed), 45);
//! # Ok::<(), pathmark::strategy::StrategyError>(())
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
//! # Adding one
//!
//! A file with its `ENTRY`, and its line in `strategies!` below. Everything else, the contract tests included, loops over the table.

mod counter;
mod discipline;
mod host;
mod locked_queue;
#[cfg(feature = "openmp")]
mod openmp;
mod panics;
mod range_stealing;
mod ranges;
mod rayon_pool;
mod self_scheduling;
mod sync;
mod taken;
mod team;

use std::io;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::thread::{self, JoinHandle};

pub use discipline::{Amount, ChunkRule, Deal, Discipline, Handout, Start, Stealing, Victim};
pub use static_blocks::block;

macro_rules! strategies {
    ($($(#[$condition:meta])* $module:ident),* $(,)?) => {
        $($(#[$condition])* mod $module;)*

        /// Every strategy there is, in the order in which people meet them.
        pub static STRATEGIES: &[Entry] = &[$($(#[$condition])* $module::ENTRY),*];
    };
}

strategies! {
    serial,
    thread_per_job,
    static_blocks,
    static_cyclic,
    shared_counter,
    dynamic,
    guided,
    trapezoid,
    factoring,
    mutex_queue,
    fixed_pool,
    work_stealing,
    steal_one,
    steal_half,
    rayon,
    rayon_join,
    rayon_scope,
    chili,
    #[cfg(feature = "openmp")]
    openmp_static,
    #[cfg(feature = "openmp")]
    openmp_dynamic,
    #[cfg(feature = "openmp")]
    openmp_guided,
}

/// The strategy called `name`.
pub fn find(name: &str) -> Option<&'static Entry> {
    STRATEGIES.iter().find(|entry| entry.name == name)
}

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

/// A strategy's line in the table.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Its name on the command line and in records.
    pub name: &'static str,
    /// What it does, in one line.
    pub about: &'static str,
    /// Where its jobs run.
    pub workers: Workers,
    /// Who starts its threads.
    pub threads: Threads,
    /// When a worker that is free finds out about jobs that wait at another one.
    pub sharing: Sharing,
    /// How it hands out jobs, given the parameter; refuses a parameter that means nothing.
    pub discipline: fn(Option<&str>) -> Result<Discipline, StrategyError>,
    /// Makes one that is ready to run; pools start their threads here.
    pub new: fn(Config) -> Result<Box<dyn Strategy>, StrategyError>,
}

/// Where a strategy's jobs run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Workers {
    /// On the thread that calls [`Strategy::run`]; [`Config::threads`] has no meaning.
    Caller,
    /// On a thread for each job; [`Config::threads`] has no meaning.
    PerJob,
    /// On as many threads as [`Config::threads`] says.
    Threads,
}

impl Workers {
    /// How many jobs can run at the same time when `threads` are asked for and there are `jobs`.
    pub fn at_once(self, threads: usize, jobs: usize) -> usize {
        match self {
            Self::Caller => jobs.min(1),
            Self::PerJob => jobs,
            Self::Threads => jobs.min(threads),
        }
    }
}

/// Who starts a strategy's threads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Threads {
    /// [`Config::spawner`], all of them.
    Spawner,
    /// One worker's thread comes from [`Config::spawner`], in the construction. The library behind the strategy starts those of the other
    /// workers by its own means, and perhaps more that run no jobs. What happens if the system refuses one of these is the library's
    /// affair; it may end the program.
    Library,
}

/// When a worker that is free finds out about jobs that wait at another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    /// At once, so as many jobs as there are workers can wait for each other.
    AtOnce,
    /// When the other one comes between two of its jobs and some time has passed. A job that waits for another one may wait for
    /// ever.
    Heartbeat,
}

/// What a strategy is made from.
#[derive(Clone)]
pub struct Config {
    /// How many workers, where the strategy asks.
    pub threads: NonZeroUsize,
    /// What follows the colon in `--strategy name:parameter`.
    pub parameter: Option<String>,
    /// Where threads come from.
    pub spawner: Arc<dyn Spawner>,
}

impl Config {
    /// `threads` real threads and no parameter.
    pub fn new(threads: NonZeroUsize) -> Self {
        Self { threads, parameter: None, spawner: Arc::new(SystemThreads) }
    }

    /// The discipline that the parameter asks of a strategy.
    fn discipline(&self, entry: &Entry) -> Result<Discipline, StrategyError> {
        (entry.discipline)(self.parameter.as_deref())
    }
}

/// For a strategy that has nothing to set: its discipline, unless a parameter was given.
fn unless_set(
    strategy: &'static str,
    parameter: Option<&str>,
    discipline: Discipline,
) -> Result<Discipline, StrategyError> {
    match parameter {
        Some(value) => Err(StrategyError::Parameter { strategy, value: value.to_owned(), allowed: "none".to_owned() }),
        None => Ok(discipline),
    }
}

/// Where threads come from; a test puts one here that runs out of them.
pub trait Spawner: Send + Sync {
    /// Starts a thread called `name` that runs `body`.
    fn spawn(&self, name: String, body: Box<dyn FnOnce() + Send + 'static>) -> io::Result<JoinHandle<()>>;
}

/// Threads of the operating system.
#[derive(Debug, Clone, Copy)]
pub struct SystemThreads;

impl Spawner for SystemThreads {
    fn spawn(&self, name: String, body: Box<dyn FnOnce() + Send + 'static>) -> io::Result<JoinHandle<()>> {
        thread::Builder::new().name(name).spawn(body)
    }
}

/// Why a strategy could not be made, or could not run.
#[derive(Debug, thiserror::Error)]
pub enum StrategyError {
    /// The system gave no thread. The workers that had been started have stopped.
    #[error("starting worker {worker} of {workers}: {source}")]
    Spawn {
        /// Which one, counted from 1.
        worker: usize,
        /// How many there should have been.
        workers: usize,
        /// What the system said.
        source: io::Error,
    },
    /// The text behind the strategy's name means nothing to it.
    #[error("strategy {strategy} = {value}: unusable parameter (allowed: {allowed})")]
    Parameter {
        /// The strategy's name.
        strategy: &'static str,
        /// The parameter as the user wrote it.
        value: String,
        /// What would be right.
        allowed: String,
    },
    /// The strategy has no numbers for so many.
    #[error("strategy {strategy}: {jobs} jobs are too many (allowed: 0 to {most})")]
    TooManyJobs {
        /// The strategy's name.
        strategy: &'static str,
        /// How many there are.
        jobs: usize,
        /// How many it can have.
        most: usize,
    },
    /// The library behind the strategy would quietly use fewer.
    #[error("strategy {strategy}: {threads} threads are too many (allowed: 1 to {most})")]
    TooManyThreads {
        /// The strategy's name.
        strategy: &'static str,
        /// How many were asked for.
        threads: usize,
        /// How many it can have.
        most: usize,
    },
}
