//! Six pools with a fault each, for students. `README.md` has their symptoms; each file has a hint and a test.
//!
//! [`answers`] has the mended pools.

pub mod early_return;
pub mod lost_job;
pub mod one_at_a_time;
pub mod short_handed;
pub mod stuck_queue;
pub mod swallowed_panic;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use pathmark_strategy::contract::{Contract, Promise, Violation};
use pathmark_strategy::{Blueprint, Entry};

/// Everything that a pool of the exercises uses.
pub mod prelude {
    pub use crate::{on_threads, take, verify_mended};
    pub use pathmark_strategy::{
        Blueprint, ChunkRule, Discipline, Entry, Job, Panics, StrategyError, Threads, each_run,
    };
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

/// Runs `work` on each of the pool's threads, but on no more than there are jobs, and waits for all.
pub fn on_threads(pool: &Blueprint, jobs: usize, work: impl Fn() + Sync) {
    thread::scope(|scope| {
        for _ in 0..pool.workers(jobs) {
            scope.spawn(&work);
        }
    });
}

/// Takes the next job from a counter that threads share.
pub fn take(next: &AtomicUsize, jobs: usize) -> Option<usize> {
    Some(next.fetch_add(1, Ordering::Relaxed)).filter(|index| *index < jobs)
}

/// Tests the contract. Some faults use up the patience, so it is shorter than usual.
pub fn verify(entry: &Entry) -> Result<(), Vec<Violation>> {
    Contract { patience: Duration::from_secs(5), ..Contract::default() }.verify(entry)
}

/// Tests the contract of an exercise with other runs.
#[macro_export]
macro_rules! verify_mended {
    ($exercise:ident, $run:expr) => {{
        let make = |blueprint: &pathmark_strategy::Blueprint| pathmark_strategy::each_run(blueprint, $run);
        pathmark_strategy::contract::verify(&pathmark_strategy::Entry { make, ..$crate::$exercise::ENTRY }).unwrap();
    }};
}
