//! The contract of every strategy, tested on any [`Entry`]: call [`verify`] from a test of your strategy.
//!
//! ```
//! use pathmark_strategy::{contract, find};
//!
//! let entry = find("static-cyclic").expect("it is in the table");
//! contract::verify(entry).unwrap();
//! ```
//!
//! Faults show in the order and number of jobs, not in times. Three verdicts need [`Contract::patience`], and their
//! violations say so. A run without progress for twice the patience counts as endless. Jobs that have not met within
//! the patience count as too few. A worker that goes on for a part of it counts as unaware of a panic.

mod case;
mod coverage;
mod discipline;
mod meeting;
mod panics;
mod parallelism;
mod spawner;
mod stopping;
mod terms;
mod threads;
mod watch;

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use crate::Entry;
use case::{Case, Check};

/// Tests every promise on `entry`'s strategy, which takes some seconds. Returns the violations, one for each broken
/// promise and kind of test case.
///
/// # Panics
///
/// Panics if the system refuses the thread for a test.
pub fn verify(entry: &Entry) -> Result<(), Vec<Violation>> {
    Contract::default().verify(entry)
}

/// The settings of [`verify`].
#[derive(Debug, Clone)]
pub struct Contract {
    /// How long jobs may take to meet before they count as too few: by default half a minute, which should be enough on
    /// any machine.
    pub patience: Duration,
    /// The strategy's parameter; its default if `None`.
    pub parameter: Option<String>,
    /// Whether to test a panic in each of a thousand jobs instead of some, which takes minutes.
    pub thorough: bool,
}

impl Default for Contract {
    fn default() -> Self {
        Self { patience: Duration::from_secs(30), parameter: None, thorough: false }
    }
}

/// A promise that a strategy breaks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Violation {
    /// The broken promise.
    pub promise: Promise,
    /// The test case: threads, jobs and their behaviour.
    pub case: String,
    /// The observed result.
    pub found: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}): {}", self.promise, self.case, self.found)
    }
}

impl std::error::Error for Violation {}

/// A promise of the contract.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Promise {
    /// The name fits a command line, and the description has one line.
    Name,
    /// An invalid parameter is refused.
    Parameter,
    /// Each job runs exactly once, for any numbers of jobs and threads, and in every run of the strategy.
    EachJobOnce,
    /// A run ends, and only when all its jobs have ended.
    End,
    /// As many jobs run at a time as `workers` and `sharing` say, and on the caller's thread only if `workers` says so.
    Workers,
    /// Jobs are handed out as `discipline` says.
    Discipline,
    /// A panic reaches the caller as it was thrown, and the strategy works again.
    Panics,
    /// After a panic, only workers that have not noticed it yet begin a further job.
    Stopping,
    /// No clone of the job is left when a run has ended.
    NoJobLeft,
    /// No thread of the spawner is left when the strategy has been dropped, and none is started without use.
    NoThreadLeft,
    /// A refused thread is an error; no job runs twice, and the strategy works again.
    Refusals,
}

impl fmt::Display for Promise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Name => "its name fits a command line",
            Self::Parameter => "an invalid parameter is refused",
            Self::EachJobOnce => "each job runs exactly once",
            Self::End => "a run ends when all its jobs have",
            Self::Workers => "as many jobs run at a time as there are workers",
            Self::Discipline => "jobs are handed out as its discipline says",
            Self::Panics => "a panic reaches the caller and the strategy works again",
            Self::Stopping => "a panic stops all workers",
            Self::NoJobLeft => "no clone of the job is left",
            Self::NoThreadLeft => "no thread is left, and none is started without use",
            Self::Refusals => "a refused thread is an error",
        })
    }
}

const CHECKS: &[(Promise, Check)] = &[
    (Promise::Name, terms::name),
    (Promise::Parameter, terms::parameter),
    (Promise::EachJobOnce, coverage::any_numbers),
    (Promise::EachJobOnce, coverage::many_runs),
    (Promise::EachJobOnce, coverage::many_jobs),
    (Promise::End, coverage::ends_last),
    (Promise::Workers, parallelism::as_many_as_told),
    (Promise::Discipline, discipline::as_told),
    (Promise::NoJobLeft, coverage::no_job_left),
    (Promise::NoThreadLeft, threads::none_in_vain),
    (Promise::NoThreadLeft, threads::none_left),
    (Promise::Refusals, threads::refused),
    (Promise::Panics, panics::in_any_job),
    (Promise::Stopping, stopping::alone),
    (Promise::Stopping, stopping::others),
];

/// Run last: here a strategy that drops the payloads of panics may end the whole program. So only strategies that keep
/// the other promises are tested.
const LAST: &[(Promise, Check)] = &[(Promise::Panics, panics::of_all_workers)];

impl Contract {
    /// As [`verify`], with these settings. After a run that does not end, nothing more is tested.
    pub fn verify(&self, entry: &Entry) -> Result<(), Vec<Violation>> {
        let case = Arc::new(Case::new(self, *entry));
        for checks in [CHECKS, LAST] {
            let violations = violations(&case, checks);
            if !violations.is_empty() {
                return Err(violations);
            }
        }
        Ok(())
    }
}

fn violations(case: &Arc<Case>, checks: &[(Promise, Check)]) -> Vec<Violation> {
    let mut violations = Vec::new();
    for &(promise, check) in checks {
        match watch::run(case, check) {
            watch::Outcome::Kept => {}
            watch::Outcome::Broken(found) => violations.push(Violation { promise, case: case.now(), found }),
            watch::Outcome::Hangs(found) => {
                violations.push(Violation { promise: Promise::End, case: case.now(), found });
                break;
            }
        }
    }
    violations
}
