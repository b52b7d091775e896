//! What every strategy promises, tried on any [`Entry`]: call [`verify`] from a test of your strategy.
//!
//! ```
//! use pathmark_strategy::{contract, find};
//!
//! let entry = find("static-cyclic").expect("it is in the table");
//! contract::verify(entry).unwrap();
//! ```
//!
//! What shows a fault is order and number, not time. Three verdicts need [`Contract::patience`], and their violations say so: a run in which
//! nothing happens for twice as long never ends, jobs that have not come together for that long never will, and a worker that goes on
//! for a part of it has not heard of a panic.

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

/// Tries every promise on `entry`'s strategy, in some seconds, and says which it breaks, one violation a promise and kind of case.
///
/// # Panics
///
/// Panics if the system gives no thread to try it on.
pub fn verify(entry: &Entry) -> Result<(), Vec<Violation>> {
    Contract::default().verify(entry)
}

/// How [`verify`] goes about it.
#[derive(Debug, Clone)]
pub struct Contract {
    /// How long jobs may take to come together before they count as too few: half a minute by default, which no machine should need.
    pub patience: Duration,
    /// What is set of the strategy; its default if `None`.
    pub parameter: Option<String>,
    /// Whether to try a panic in each of a thousand jobs instead of some: minutes.
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
    /// What was promised.
    pub promise: Promise,
    /// When it was broken: threads, jobs and what they did.
    pub case: String,
    /// What happened instead.
    pub found: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}): {}", self.promise, self.case, self.found)
    }
}

impl std::error::Error for Violation {}

/// What a strategy promises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Promise {
    /// A name that fits a command line, and what it does in one line.
    Name,
    /// A parameter that means nothing is refused.
    Parameter,
    /// Each job runs exactly once, however many jobs and threads there are, and however often the strategy is used.
    EachJobOnce,
    /// A run ends, and only when all its jobs have.
    End,
    /// As many jobs at a time as `workers` and `sharing` say, on threads that are not the caller's.
    Workers,
    /// Jobs are handed out as `discipline` says.
    Discipline,
    /// A panic reaches the caller as it was thrown, and the strategy works again.
    Panics,
    /// After a panic no worker begins a further job, but for those that have not heard of it yet.
    Stopping,
    /// No clone of the job is left when a run has ended.
    NoJobLeft,
    /// No thread of the spawner is left when the strategy has been dropped, and no more are started than there is use for.
    NoThreadLeft,
    /// A thread that is refused is an error; no job runs twice, and the strategy works again.
    Refusals,
}

impl fmt::Display for Promise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Name => "its name fits a command line",
            Self::Parameter => "a parameter that means nothing is refused",
            Self::EachJobOnce => "each job runs exactly once",
            Self::End => "a run ends when all its jobs have",
            Self::Workers => "as many jobs run at a time as there are workers",
            Self::Discipline => "jobs are handed out as its discipline says",
            Self::Panics => "a panic reaches the caller and the strategy works again",
            Self::Stopping => "a panic stops all workers",
            Self::NoJobLeft => "no clone of the job is left",
            Self::NoThreadLeft => "no thread is left, and none is started in vain",
            Self::Refusals => "a thread that is refused is an error",
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

/// A strategy that drops what its jobs throw may end the whole program here: only those that keep the other promises come this far.
const LAST: &[(Promise, Check)] = &[(Promise::Panics, panics::of_all_workers)];

impl Contract {
    /// As [`verify`], on these terms. After a run that does not end nothing more is tried.
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
