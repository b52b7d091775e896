//! The pools of the students: a sound one, those of the exercises, and cheats.

use pathmark::strategy::{Blueprint, Config, Discipline, Entry, Job, Strategy, StrategyError, find};
use pathmark_exercises::EXERCISES;
use std::sync::Arc;
use std::thread;
use std::time::Instant;

/// A run of a pool around a sound one.
type Run = fn(&mut dyn Strategy, usize, Job) -> Result<(), StrategyError>;

struct Around {
    inner: Box<dyn Strategy>,
    run: Run,
}

impl Strategy for Around {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        (self.run)(&mut *self.inner, jobs, job)
    }
}

fn around(blueprint: &Blueprint, run: Run) -> Result<Box<dyn Strategy>, StrategyError> {
    let config = Config { spawner: Arc::clone(&blueprint.spawner), ..Config::new(blueprint.threads) };
    let inner = find("shared-counter").expect("it is in the table").build(config)?;
    Ok(Box::new(Around { inner, run }))
}

const fn entry(name: &'static str, make: fn(&Blueprint) -> Result<Box<dyn Strategy>, StrategyError>) -> Entry {
    Entry::new(name, "a pool of a student", Discipline::ONE_BY_ONE, make)
}

/// The rows of the images in these tests: no case of the contract has as many jobs.
pub(crate) const ROWS: usize = 37;

const OWN: [Entry; 4] = [
    entry("sound", |blueprint| around(blueprint, |pool, jobs, job| pool.run(jobs, job))),
    entry("twice", |blueprint| {
        around(blueprint, |pool, jobs, job| {
            pool.run(jobs, Arc::new(move |index| (0..=usize::from(index == 0)).for_each(|_| job(index))))
        })
    }),
    // It keeps the contract, and loses a job of the render.
    entry("cheat", |blueprint| around(blueprint, |pool, jobs, job| pool.run(jobs - usize::from(jobs == ROWS), job))),
    // It sleeps for longer than its jobs take, however busy the machine is.
    entry("sleeper", |blueprint| {
        around(blueprint, |pool, jobs, job| {
            let begun = Instant::now();
            let outcome = pool.run(jobs, job);
            thread::sleep(4 * begun.elapsed());
            outcome
        })
    }),
];

pub(crate) fn named(name: &str) -> Entry {
    let mut all = OWN.into_iter().chain(EXERCISES.into_iter().map(|(entry, _)| entry));
    all.find(|entry| entry.name == name).unwrap_or_else(|| panic!("no pool is named {name}"))
}
