//! Why a strategy could not be made, or could not run.

use std::io;

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
        allowed: &'static str,
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
