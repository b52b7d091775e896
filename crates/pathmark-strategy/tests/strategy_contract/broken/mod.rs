//! Strategies with one fault each, which the contract must notice: that is how it is seen red.

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

/// What goes wrong in a run.
type Run = fn(&mut Broken, usize, Job) -> Result<(), StrategyError>;

/// A sound strategy, and what is made of it.
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

/// The strategy of another name, made from the same.
fn other(name: &str, blueprint: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    of_threads(name, blueprint.threads.get(), &blueprint.spawner)
}

/// The strategy of another name on so many threads, but at least one.
fn of_threads(name: &str, threads: usize, spawner: &Arc<dyn Spawner>) -> Result<Box<dyn Strategy>, StrategyError> {
    let (name, parameter) = name.split_once(':').map_or((name, None), |(name, value)| (name, Some(value.to_owned())));
    let threads = NonZeroUsize::new(threads).unwrap_or(NonZeroUsize::MIN);
    find(name).expect("it is in the table").build(Config { threads, parameter, spawner: Arc::clone(spawner) })
}

/// Says that it hands out jobs one by one.
const fn made_by(make: fn(&Blueprint) -> Result<Box<dyn Strategy>, StrategyError>) -> Entry {
    Entry::new("faulty", "for a test", Discipline::ONE_BY_ONE, make)
}

/// Makes what runs on `shared-counter` and has this wrong with its runs.
macro_rules! runs {
    ($run:expr) => {
        crate::broken::made_by(|blueprint| crate::broken::broken(blueprint, $run))
    };
}
use runs;

/// Less patient than for a sound strategy, since some faults are waiting in vain. Still seconds: all faults are tried at once, and a panic
/// prints a backtrace for which the others wait; a check that stands still for so long would count as a run that never ends.
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

/// The same without a fault.
#[test]
fn the_contract_finds_no_fault_where_there_is_none() {
    let sound = runs!(|broken, jobs, job| broken.inner.run(jobs, job));
    assert_eq!(promises_broken_by(&sound, Contract::default().patience), []);
}
