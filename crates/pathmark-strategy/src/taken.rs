//! When a worker that finds no job may leave: how many jobs have been taken to run, by all workers together.
//!
//! That every queue looks empty doesn't say that nothing is left to find: a batch on its way from one queue to another is in neither, and
//! a worker that left then would be missing when the thief is held up in its first job. So workers stay until all jobs have been taken.
//! Who has to wait here waits for a batch to arrive, never for a job to end.

use super::panics::Panics;
use super::sync::{AtomicUsize, Backoff, CachePadded, Ordering};

/// How many jobs each worker of a run has taken.
pub(super) struct Taken {
    jobs: usize,
    /// One counter each, since one for all would be the shared counter again.
    by_worker: Box<[CachePadded<AtomicUsize>]>,
}

impl Taken {
    /// None of `jobs` has been taken by any of `workers`.
    pub(super) fn new(jobs: usize, workers: usize) -> Self {
        Self { jobs, by_worker: (0..workers).map(|_| CachePadded::default()).collect() }
    }

    /// What `worker` does in a run: runs what `next` finds, until all jobs have been taken or a stop is asked for.
    pub(super) fn work(
        &self,
        worker: usize,
        panics: &Panics,
        mut next: impl FnMut() -> Option<usize>,
        job: impl Fn(usize),
    ) {
        let mut taken = 0;
        let mut backoff = Backoff::new();
        while !panics.stop_asked() {
            if let Some(index) = next() {
                taken += 1;
                // Nobody else writes here.
                self.by_worker[worker].store(taken, Ordering::Relaxed);
                job(index);
                backoff = Backoff::new();
            } else if self.all() {
                break;
            } else {
                backoff.snooze();
            }
        }
    }

    /// Whether there is nothing left to find.
    fn all(&self) -> bool {
        self.by_worker.iter().map(|taken| taken.load(Ordering::Relaxed)).sum::<usize>() == self.jobs
    }
}
