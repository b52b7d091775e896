//! Strategies with one fault each, which the contract must notice; this shows that its checks can fail.

mod faults;
mod jobs;

use std::num::NonZeroUsize;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use pathmark_strategy::contract::{Contract, Promise};
use pathmark_strategy::{Blueprint, Config, Discipline, Entry, Job, Spawner, Strategy, StrategyError, find};

/// A fault, the promise that it breaks, and a strategy that has it.
type Fault = (&'static str, Promise, Entry);

/// A run with a fault.
type Run = fn(&mut Broken, usize, Job) -> Result<(), StrategyError>;

/// A sound strategy, and the fault in its runs.
struct Broken {
    inner: Box<dyn Strategy>,
    blueprint: Blueprint,
    run: Run,
    kept: Vec<Job>,
    panicked: bool,
}

impl Strategy for Broken {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        (self.run)(self, jobs, job)
    }
}

fn broken(blueprint: &Blueprint, run: Run) -> Result<Box<dyn Strategy>, StrategyError> {
    let inner = other("shared-counter", blueprint)?;
    Ok(Box::new(Broken { inner, blueprint: blueprint.clone(), run, kept: Vec::new(), panicked: false }))
}

/// Makes the strategy called `name` from the same blueprint.
fn other(name: &str, blueprint: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    of_threads(name, blueprint.threads.get(), &blueprint.spawner)
}

/// Makes the strategy called `name` on `threads` threads, but at least one.
fn of_threads(name: &str, threads: usize, spawner: &Arc<dyn Spawner>) -> Result<Box<dyn Strategy>, StrategyError> {
    let (name, parameter) = name.split_once(':').map_or((name, None), |(name, value)| (name, Some(value.to_owned())));
    let threads = NonZeroUsize::new(threads).unwrap_or(NonZeroUsize::MIN);
    find(name).expect("it is in the table").build(Config { threads, parameter, spawner: Arc::clone(spawner) })
}

/// Returns an entry that claims to hand out jobs one by one.
const fn made_by(make: fn(&Blueprint) -> Result<Box<dyn Strategy>, StrategyError>) -> Entry {
    Entry::new("faulty", "for a test", Discipline::ONE_BY_ONE, make)
}

/// The entry of a strategy on `shared-counter` with this fault in its runs.
macro_rules! runs {
    ($run:expr) => {
        crate::broken::made_by(|blueprint| crate::broken::broken(blueprint, $run))
    };
}
use runs;

/// Shorter than for a sound strategy, because some faults use up the patience. Still seconds: all faults are tested at
/// once, and the others wait while a panic prints a backtrace. A check that makes no progress for so long would count
/// as a run that never ends.
const PATIENCE: Duration = Duration::from_secs(5);

fn promises_broken_by(entry: &Entry, patience: Duration) -> Vec<Promise> {
    let violations = Contract { patience, ..Contract::default() }.verify(entry).err().unwrap_or_default();
    violations.into_iter().map(|violation| violation.promise).collect()
}

#[test]
fn the_contract_notices_each_fault() {
    let faults: Vec<Fault> = [faults::FAULTS, jobs::FAULTS].concat();
    let missed: Vec<_> = thread::scope(|scope| {
        let tried = faults
            .iter()
            .map(|(fault, promise, entry)| (fault, promise, scope.spawn(|| promises_broken_by(entry, PATIENCE))));
        let judged = tried
            .collect::<Vec<_>>()
            .into_iter()
            .map(|(fault, promise, judge)| (fault, promise, judge.join().unwrap()));
        judged.filter(|(_, promise, broken)| !broken.contains(promise)).collect()
    });
    assert!(missed.is_empty(), "not noticed: {missed:#?}");
}

/// A strategy without a fault, made in the same way.
#[test]
fn the_contract_finds_no_fault_where_there_is_none() {
    let sound = runs!(|broken, jobs, job| broken.inner.run(jobs, job));
    assert_eq!(promises_broken_by(&sound, Contract::default().patience), []);
}
