//! Errors of making and running strategies.

use std::io;

/// The reason why a strategy could not be made or could not run.
#[derive(Debug, thiserror::Error)]
pub enum StrategyError {
    /// The system refused a thread. The workers started before it have stopped.
    #[error("starting worker {worker} of {workers}: {source}")]
    Spawn {
        /// The number of the refused worker, counted from 1.
        worker: usize,
        /// Number of workers that should have started.
        workers: usize,
        /// The system's error.
        source: io::Error,
    },
    /// The text after the strategy's name is not a valid parameter.
    #[error("strategy {strategy} = {value}: invalid parameter (allowed: {allowed})")]
    Parameter {
        /// The strategy's name.
        strategy: &'static str,
        /// The parameter as the user wrote it.
        value: String,
        /// The allowed values.
        allowed: &'static str,
    },
    /// The strategy cannot number so many jobs.
    #[error("strategy {strategy}: {jobs} jobs are too many (allowed: 0 to {most})")]
    TooManyJobs {
        /// The strategy's name.
        strategy: &'static str,
        /// Number of jobs.
        jobs: usize,
        /// Largest number of jobs that the strategy supports.
        most: usize,
    },
    /// The library behind the strategy would silently use fewer threads.
    #[error("strategy {strategy}: {threads} threads are too many (allowed: 1 to {most})")]
    TooManyThreads {
        /// The strategy's name.
        strategy: &'static str,
        /// Number of threads requested.
        threads: usize,
        /// Largest number of threads that the strategy supports.
        most: usize,
    },
}
