//! Our own concurrent primitives under loom, which runs a small program in every interleaving with up to two preemptions (three in thorough mode),
//! and with every value that a relaxed load may see.
//!
//! The files of `src` are included here unchanged; their imports from `super::sync` are loom's types instead of std's.

#[path = "../../src/counter.rs"]
mod counter;
#[path = "../../src/locked_queue.rs"]
mod locked_queue;
#[path = "../../src/panics.rs"]
pub mod panics;
#[path = "../../src/ranges.rs"]
mod ranges;
mod stealing;
mod sync;
#[path = "../../src/taken.rs"]
mod taken;

use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;

use loom::sync::atomic::{AtomicUsize, Ordering};

use counter::Counter;
use locked_queue::LockedQueue;
use panics::Panics;

/// Tries `model` in every interleaving. A model that does not end in one of them fails.
fn check(model: impl Fn() + Sync + Send + 'static) {
    let mut builder = loom::model::Builder::new();
    builder.preemption_bound = Some(if std::env::var_os("PATHMARK_THOROUGH").is_some() { 3 } else { 2 });
    builder.check(model);
}

/// Runs `body(0)`, `body(1)` and so on, the first on this thread, and returns when all have ended.
fn team(workers: usize, body: impl Fn(usize) + Send + Sync + 'static) {
    let body = Arc::new(body);
    let others: Vec<_> = (1..workers)
        .map(|worker| {
            let body = Arc::clone(&body);
            loom::thread::spawn(move || body(worker))
        })
        .collect();
    body(0);
    for other in others {
        other.join().unwrap();
    }
}

/// How often each job has run.
#[derive(Clone)]
struct Runs(Arc<[AtomicUsize]>);

impl Runs {
    fn new(jobs: usize) -> Self {
        Self((0..jobs).map(|_| AtomicUsize::new(0)).collect())
    }

    fn note(&self, job: usize) {
        self.0[job].fetch_add(1, Ordering::Relaxed);
    }

    fn of(&self, job: usize) -> usize {
        self.0[job].load(Ordering::Relaxed)
    }

    fn assert_each_once(&self) {
        let counts: Vec<_> = (0..self.0.len()).map(|job| self.of(job)).collect();
        assert!(counts.iter().all(|&runs| runs == 1), "{counts:?}");
    }
}

#[test]
fn a_counter_hands_out_each_number_once() {
    const JOBS: usize = 3;
    check(|| {
        let (counter, runs) = (Counter::default(), Runs::new(JOBS));
        let noted = runs.clone();
        team(3, move |_| {
            while let Some(job) = Some(counter.take()).filter(|job| *job < JOBS) {
                noted.note(job);
            }
        });
        runs.assert_each_once();
    });
}

#[test]
fn a_locked_queue_hands_out_each_job_once() {
    const JOBS: usize = 3;
    check(|| {
        let (queue, runs) = (LockedQueue::new(JOBS), Runs::new(JOBS));
        let noted = runs.clone();
        team(3, move |_| {
            while let Some(job) = queue.take() {
                noted.note(job);
            }
        });
        runs.assert_each_once();
    });
}

/// One worker throws 0 and later 2, the other throws 1. The first payload is 0 or 1, never 2.
#[test]
fn the_first_payload_is_raised_and_everyone_is_asked_to_stop() {
    check(|| {
        let panics = Arc::new(Panics::default());
        let theirs = Arc::clone(&panics);
        team(2, move |worker| {
            theirs.catch(|| panic::resume_unwind(Box::new(worker)));
            assert!(theirs.stop_asked(), "who has thrown sees the wish to stop");
            theirs.attempt(|| panic::resume_unwind(Box::new(3_usize)));
            if worker == 0 {
                theirs.catch(|| panic::resume_unwind(Box::new(2_usize)));
            }
        });
        let raise = || panic::catch_unwind(AssertUnwindSafe(|| panics.raise()));
        let raised = raise().expect_err("something was thrown");
        assert!(raised.downcast_ref::<usize>().is_some_and(|thrown| *thrown < 2), "{raised:?}");
        assert!(panics.stop_asked() && raise().is_ok(), "it is raised once");
    });
}

/// The stop request reaches a worker that has thrown nothing: once it has seen the request it begins no job, and the
/// run ends.
#[test]
fn a_worker_that_sees_the_wish_takes_no_job() {
    check(|| {
        let (panics, runs) = (Arc::new(Panics::default()), Runs::new(1));
        let (theirs, noted) = (Arc::clone(&panics), runs.clone());
        team(2, move |worker| {
            if worker == 0 {
                theirs.ask_to_stop();
                return;
            }
            while !theirs.stop_asked() {
                loom::thread::yield_now();
            }
            theirs.attempt(|| noted.note(0));
        });
        assert_eq!(runs.of(0), 0);
        panics.raise();
    });
}
