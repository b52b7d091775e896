//! F05: a panic in job k of 1000, for every k, under every strategy: the original payload reaches the caller, and the strategy works again.

use std::panic::{self, AssertUnwindSafe};
use std::sync::{Arc, Mutex, PoisonError};

use pathmark::strategy::{Job, STRATEGIES, Workers};

use crate::support::{Runs, TestSpawner, guarded, threads};

const JOBS: usize = 1000;

/// What went wrong in a job, told without a report on stderr for each of some ten thousand.
fn throw(index: usize) {
    panic::resume_unwind(Box::new(format!("job {index} fails")));
}

/// Panics while the job's own values are dropped.
struct Bomb(usize);

impl Drop for Bomb {
    fn drop(&mut self) {
        throw(self.0);
    }
}

/// Panics somewhere in job `index`; the lock is all jobs'.
type Way = fn(usize, &Mutex<usize>);

/// Where in a job a panic may start.
const WAYS: [(&str, Way); 3] = [
    ("in its body", |index, _| throw(index)),
    ("in a drop", |index, _| drop(Bomb(index))),
    ("while it holds a lock", |index, shared| {
        let _held = shared.lock().unwrap_or_else(PoisonError::into_inner);
        throw(index);
    }),
];

/// Job `culprit` panics in one way, and all others take a lock that it may have poisoned.
fn job(culprit: usize, way: Way) -> Job {
    let shared = Mutex::new(0);
    Arc::new(move |index| {
        if index == culprit {
            way(index, &shared);
        }
        *shared.lock().unwrap_or_else(PoisonError::into_inner) += 1;
    })
}

#[test]
fn a_panic_in_any_of_a_thousand_jobs_is_told_and_survived() {
    let thorough = std::env::var_os("PATHMARK_THOROUGH").is_some();
    for entry in STRATEGIES {
        // A thread for each job, a thousand times over, takes a minute; and its own number of threads is not read.
        let (step, counts): (usize, &[usize]) = match entry.workers {
            Workers::Threads => (if thorough { 1 } else { 9 }, &[1, 2, 8]),
            Workers::Caller => (1, &[1]),
            Workers::PerJob => (if thorough { 1 } else { 99 }, &[1]),
        };
        for &workers in counts {
            let spawner = TestSpawner::unlimited();
            let mut strategy = (entry.new)(spawner.config(threads(workers))).unwrap();
            for culprit in (0..JOBS).step_by(step) {
                let (way, throws) = WAYS[culprit % WAYS.len()];
                let what = format!("{}, {workers} threads, job {culprit} panics {way}", entry.name);
                guarded(&what, || {
                    let run = AssertUnwindSafe(|| strategy.run(JOBS, job(culprit, throws)));
                    let payload = panic::catch_unwind(run).expect_err("the panic reaches the caller");
                    assert_eq!(payload.downcast_ref::<String>(), Some(&format!("job {culprit} fails")));
                    let again = Runs::new(20);
                    strategy.run(20, again.job()).unwrap();
                    assert!(again.each_once(), "{:?}", again.counts());
                });
            }
            drop(strategy);
            assert_eq!(spawner.alive(), 0, "{}, {workers} threads", entry.name);
        }
    }
}
