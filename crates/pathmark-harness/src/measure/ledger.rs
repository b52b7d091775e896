//! Ledger of a run: which job ran when, on which worker, with a check that each ran exactly once.
//!
//! Each job has one entry, taken out and put back by a pointer swap, so that no job waits for another. With two
//! readings of the clock, measuring a job costs some 0.1 microseconds (`cargo bench`, group `trace`).

use super::JobSpan;
use crate::kernel::Counts;
use crossbeam::atomic::AtomicCell;
use std::cell::Cell;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::Instant;

/// The measurements of one job.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Entry {
    pub(super) counts: Counts,
    pub(super) span: JobSpan,
    times_run: u32,
}

/// The entries of a run. One is missing while its job runs.
pub(super) struct Ledger {
    entries: Vec<AtomicCell<Option<Box<Entry>>>>,
    /// Jobs that found their entry missing: another thread was running them.
    collisions: AtomicU32,
    workers: AtomicU32,
    run: u64,
    /// Jobs done, for progress displays.
    done: AtomicU64,
}

thread_local! {
    /// The run that last numbered this thread, and its number there: pools keep their threads over several runs.
    static WORKER: Cell<(u64, u32)> = const { Cell::new((0, 0)) };
}

impl Ledger {
    /// Returns a ledger of jobs of which none has run.
    pub(super) fn new(jobs: usize) -> Self {
        static RUNS: AtomicU64 = AtomicU64::new(1);
        Self {
            entries: (0..jobs).map(|_| AtomicCell::new(Some(Box::default()))).collect(),
            collisions: AtomicU32::new(0),
            workers: AtomicU32::new(0),
            run: RUNS.fetch_add(1, Ordering::Relaxed),
            done: AtomicU64::new(0),
        }
    }

    fn worker(&self) -> u32 {
        WORKER.with(|cell| {
            let (run, worker) = cell.get();
            if run == self.run {
                return worker;
            }
            let worker = self.workers.fetch_add(1, Ordering::Relaxed);
            cell.set((self.run, worker));
            worker
        })
    }

    /// Runs `work` as job `index`, and records its times: the body of every strategy's job.
    pub(super) fn record(&self, index: usize, start: Instant, work: impl FnOnce() -> Counts) {
        let Some(mut entry) = self.entries[index].take() else {
            self.collisions.fetch_add(1, Ordering::Relaxed);
            return;
        };
        entry.span.worker = self.worker();
        entry.span.start_s = start.elapsed().as_secs_f64();
        entry.counts = work();
        entry.span.stop_s = start.elapsed().as_secs_f64();
        entry.times_run += 1;
        self.entries[index].store(Some(entry));
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    /// Records the times of job `index`, which ran together with others; `work` delivers its result.
    pub(super) fn enter(&self, index: usize, [start_s, stop_s]: [f64; 2], work: impl FnOnce() -> Counts) {
        let Some(mut entry) = self.entries[index].take() else {
            self.collisions.fetch_add(1, Ordering::Relaxed);
            return;
        };
        entry.span = JobSpan { worker: self.worker(), start_s, stop_s };
        entry.counts = work();
        entry.times_run += 1;
        self.entries[index].store(Some(entry));
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    /// Jobs done so far.
    pub(super) fn done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }

    /// Threads that ran at least one job.
    pub(super) fn workers_used(&self) -> u32 {
        self.workers.load(Ordering::Relaxed)
    }

    /// Takes the entries out, in index order. The error names a job that did not run exactly once.
    pub(super) fn close(&self) -> Result<Vec<Entry>, String> {
        let collisions = self.collisions.load(Ordering::Relaxed);
        if collisions > 0 {
            return Err(format!("{collisions} jobs were started while they were already running"));
        }
        let mut closed = Vec::with_capacity(self.entries.len());
        for (index, cell) in self.entries.iter().enumerate() {
            match cell.take() {
                Some(entry) if entry.times_run == 1 => closed.push(*entry),
                Some(entry) => return Err(format!("job {index} ran {} times instead of once", entry.times_run)),
                None => return Err(format!("job {index} did not finish")),
            }
        }
        Ok(closed)
    }
}
