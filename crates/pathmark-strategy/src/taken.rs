//! The end of a run: workers without a job may leave only when all jobs have been taken.
//!
//! Empty queues do not mean that no job is left: a batch on its way from one queue to another is in neither. A worker
//! that left then would be missing while the thief is busy with the batch's first job. So workers stay until all jobs
//! have been taken. A waiting worker waits for a batch to arrive, never for a job to end.

use super::panics::Panics;
use super::sync::{AtomicUsize, Backoff, CachePadded, Ordering};

/// The number of jobs that each worker of a run has taken.
pub(super) struct Taken {
    jobs: usize,
    /// One counter for each worker: a single counter would be as contended as the shared counter.
    by_worker: Box<[CachePadded<AtomicUsize>]>,
}

impl Taken {
    /// Returns the state in which none of `jobs` has been taken by any of `workers`.
    pub(super) fn new(jobs: usize, workers: usize) -> Self {
        Self { jobs, by_worker: (0..workers).map(|_| CachePadded::default()).collect() }
    }

    /// Runs the jobs that `next` finds for `worker`, until all jobs have been taken or a stop is requested.
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
                // No other worker writes this counter.
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

    /// Returns whether all jobs have been taken.
    fn all(&self) -> bool {
        self.by_worker.iter().map(|taken| taken.load(Ordering::Relaxed)).sum::<usize>() == self.jobs
    }
}
