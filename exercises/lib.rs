//! Six pools with a fault each, for students. `README.md` has their symptoms; each file has a hint and a test.
//!
//! [`answers`] has the mended pools.

pub mod early_return;
pub mod lost_job;
pub mod one_at_a_time;
pub mod short_handed;
pub mod stuck_queue;
pub mod swallowed_panic;

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use pathmark_strategy::contract::{Contract, Promise, Violation};
use pathmark_strategy::{Blueprint, Entry, Job, Spawner, Strategy, StrategyError};

/// Everything that a pool of the exercises uses.
pub mod prelude {
    pub use crate::{Pool, take, verify_mended};
    pub use pathmark_strategy::{ChunkRule, Discipline, Entry, Job, Panics, StrategyError, Threads};
    pub use std::collections::VecDeque;
    pub use std::sync::atomic::{AtomicUsize, Ordering};
    pub use std::sync::{Arc, Mutex, PoisonError, mpsc};
    pub use std::thread;
}

/// The mended pools, one for each exercise.
#[doc = include_str!("../docs/course/exercises.md")]
pub mod answers {}

/// The exercises, each with the promise that it breaks.
pub const EXERCISES: [(Entry, Promise); 6] = [
    (lost_job::ENTRY, Promise::EachJobOnce),
    (early_return::ENTRY, Promise::End),
    (stuck_queue::ENTRY, Promise::End),
    (one_at_a_time::ENTRY, Promise::Workers),
    (swallowed_panic::ENTRY, Promise::Panics),
    (short_handed::ENTRY, Promise::Refusals),
];

/// A pool whose runs are a function: all that an exercise has to write.
pub struct Pool {
    pub threads: usize,
    pub spawner: Arc<dyn Spawner>,
    run: Run,
}

/// Calls the job once for each index below the number of jobs.
pub type Run = fn(&Pool, usize, &Job) -> Result<(), StrategyError>;

impl Pool {
    /// Makes a pool with these runs.
    pub fn make(blueprint: &Blueprint, run: Run) -> Result<Box<dyn Strategy>, StrategyError> {
        let Blueprint { threads, spawner, .. } = blueprint;
        Ok(Box::new(Self { threads: threads.get(), spawner: Arc::clone(spawner), run }))
    }

    /// Runs `work` on each of its threads, but on no more than there are jobs, and waits for all.
    pub fn on_threads(&self, jobs: usize, work: impl Fn() + Sync) {
        thread::scope(|scope| {
            for _ in 0..self.threads.min(jobs) {
                scope.spawn(&work);
            }
        });
    }
}

/// Takes the next job from a counter that threads share.
pub fn take(next: &AtomicUsize, jobs: usize) -> Option<usize> {
    Some(next.fetch_add(1, Ordering::Relaxed)).filter(|index| *index < jobs)
}

impl Strategy for Pool {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        (self.run)(self, jobs, &job)
    }
}

/// Tests the contract. Some faults use up the patience, so it is shorter than usual.
pub fn verify(entry: &Entry) -> Result<(), Vec<Violation>> {
    Contract { patience: Duration::from_secs(5), ..Contract::default() }.verify(entry)
}

/// Tests the contract of an exercise with other runs.
#[macro_export]
macro_rules! verify_mended {
    ($exercise:ident, $run:expr) => {{
        let make = |blueprint: &pathmark_strategy::Blueprint| $crate::Pool::make(blueprint, $run);
        pathmark_strategy::contract::verify(&pathmark_strategy::Entry { make, ..$crate::$exercise::ENTRY }).unwrap();
    }};
}
