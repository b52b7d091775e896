//! The current test case, and a record of the jobs that ran.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::Contract;
use super::spawner::CountedThreads;
use crate::{Config, Entry, Job, Spawner, Strategy, StrategyError};

/// A test of one promise; its error describes the violation.
pub(super) type Check = fn(&Case) -> Result<(), String>;

/// The tested numbers of threads.
const THREADS: [usize; 4] = [1, 2, 3, 8];

/// The strategy under test.
pub(super) struct Case {
    pub(super) contract: Contract,
    pub(super) entry: Entry,
    now: Mutex<String>,
    pulse: Arc<AtomicUsize>,
}

impl Case {
    pub(super) fn new(contract: &Contract, entry: Entry) -> Self {
        Self { contract: contract.clone(), entry, now: Mutex::default(), pulse: Arc::default() }
    }

    /// Describes the test case that begins.
    pub(super) fn at(&self, what: impl Into<String>) {
        *self.now.lock().unwrap_or_else(PoisonError::into_inner) = what.into();
        self.pulse.fetch_add(1, Ordering::Relaxed);
    }

    /// Returns the description of the current or last test case.
    pub(super) fn now(&self) -> String {
        self.now.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns a number that changes with every sign of progress.
    pub(super) fn pulse(&self) -> usize {
        self.pulse.load(Ordering::Relaxed)
    }

    /// Returns the tested numbers of threads that the strategy accepts.
    pub(super) fn threads(&self) -> impl Iterator<Item = usize> {
        THREADS.into_iter().filter(|&threads| {
            let too_many = matches!(
                self.try_build(threads, &CountedThreads::unlimited()),
                Err(StrategyError::TooManyThreads { .. })
            );
            threads == 1 || !too_many
        })
    }

    /// Returns the largest of these numbers up to `most`.
    pub(super) fn up_to(&self, most: usize) -> usize {
        self.threads().filter(|&threads| threads <= most).max().unwrap_or(1)
    }

    /// Makes the strategy with `threads` threads from `spawner`.
    pub(super) fn try_build(
        &self,
        threads: usize,
        spawner: &Arc<CountedThreads>,
    ) -> Result<Box<dyn Strategy>, StrategyError> {
        self.entry.build(Config {
            parameter: self.contract.parameter.clone(),
            spawner: Arc::clone(spawner) as Arc<dyn Spawner>,
            ..Config::new(NonZeroUsize::new(threads).unwrap_or(NonZeroUsize::MIN))
        })
    }

    /// As [`Case::try_build`], but a failure is a violation.
    pub(super) fn build(&self, threads: usize, spawner: &Arc<CountedThreads>) -> Result<Box<dyn Strategy>, String> {
        self.try_build(threads, spawner).map_err(|error| format!("the strategy cannot be built: {error}"))
    }

    /// Makes the strategy with `threads` threads from an unlimited spawner.
    pub(super) fn ready(&self, threads: usize) -> Result<Box<dyn Strategy>, String> {
        self.build(threads, &CountedThreads::unlimited())
    }

    /// Returns a record for `jobs` jobs.
    pub(super) fn runs(&self, jobs: usize) -> Runs {
        Runs { counts: (0..jobs).map(|_| AtomicUsize::new(0)).collect(), pulse: Arc::clone(&self.pulse) }
    }

    /// Runs `jobs` jobs that do nothing and checks that each has run once.
    pub(super) fn run_each_once(&self, strategy: &mut dyn Strategy, jobs: usize) -> Result<(), String> {
        let runs = self.runs(jobs);
        run(strategy, jobs, runs.job())?;
        runs.each_once()
    }
}

/// Runs `job` with all indices; an error of the run is a violation.
pub(super) fn run(strategy: &mut dyn Strategy, jobs: usize, job: Job) -> Result<(), String> {
    strategy.run(jobs, job).map_err(|error| format!("the run failed: {error}"))
}

/// A record of how often each job has begun.
#[derive(Clone)]
pub(super) struct Runs {
    counts: Arc<[AtomicUsize]>,
    pulse: Arc<AtomicUsize>,
}

impl Runs {
    /// Returns a job that is recorded and does nothing else.
    pub(super) fn job(&self) -> Job {
        let runs = self.clone();
        Arc::new(move |index| runs.note(index))
    }

    /// Records that job `index` has begun. An index that no job has counts as two runs of the last job, a violation.
    pub(super) fn note(&self, index: usize) {
        self.pulse.fetch_add(1, Ordering::Relaxed);
        if let Some(count) = self.counts.get(index) {
            count.fetch_add(1, Ordering::SeqCst);
        } else if let Some(last) = self.counts.last() {
            last.fetch_add(2, Ordering::SeqCst);
        }
    }

    fn counts(&self) -> impl Iterator<Item = usize> {
        self.counts.iter().map(|count| count.load(Ordering::SeqCst))
    }

    /// Returns how many jobs have begun, repeated ones included.
    pub(super) fn started(&self) -> usize {
        self.counts().sum()
    }

    pub(super) fn each_once(&self) -> Result<(), String> {
        self.all(|count| count == 1)
    }

    pub(super) fn none_twice(&self) -> Result<(), String> {
        self.all(|count| count <= 1)
    }

    fn all(&self, right: fn(usize) -> bool) -> Result<(), String> {
        let wrong = self.counts().filter(|&count| !right(count)).count();
        match self.counts().enumerate().find(|&(_, count)| !right(count)) {
            Some((index, count)) => {
                Err(format!("job {index} ran {count} times; {wrong} of {} jobs are wrong", self.counts.len()))
            }
            None => Ok(()),
        }
    }
}
