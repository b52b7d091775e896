//! Ledger of a run: which job ran when, on which worker, with a check that each ran exactly once.
//!
//! Each job has one entry, taken out and put back by a pointer swap, so that no job waits for another. With two
//! readings of the clock, measuring a job costs some 0.1 microseconds (`cargo bench`, group `trace`).
//!
//! The ledger also pins workers: only here is a thread known to be a worker, whichever library started it. A thread
//! pays for its pin before the clock of its first job is read.

use super::JobSpan;
use crate::error::{Error, Result};
use crate::kernel::Counts;
use crate::machine::{current_cpu, pin_thread};
use crossbeam::atomic::AtomicCell;
use std::cell::Cell;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, AtomicU64, AtomicUsize, Ordering};
use std::time::Instant;

/// The measurements of one job.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Entry {
    pub(super) counts: Counts,
    pub(super) span: JobSpan,
    /// The processor on which the job began; `None` if the system does not tell.
    cpu: Option<u32>,
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
    pins: Pins,
}

/// The processors of workers, in the order of their first jobs; empty if workers are not pinned.
#[derive(Default)]
struct Pins {
    cpus: Vec<usize>,
    next: AtomicUsize,
    failure: OnceLock<Error>,
}

impl Pins {
    /// Pins this thread to the next processor. A strategy that breaks its contract may use more threads than there are
    /// processors, and begins again with the first.
    fn pin(&self) {
        if self.cpus.is_empty() {
            return;
        }
        let place = self.next.fetch_add(1, Ordering::Relaxed) % self.cpus.len();
        if let Err(error) = pin_thread(&self.cpus[place..=place]) {
            self.failure.set(error).ok();
        }
    }
}

thread_local! {
    /// The run that last numbered this thread, and its number there: pools keep their threads over several runs.
    static WORKER: Cell<(u64, u32)> = const { Cell::new((0, 0)) };
}

impl Ledger {
    /// Returns a ledger of jobs of which none has run. It pins the worker that comes first to the first of the
    /// processors, and so on; none if there are no processors.
    pub(super) fn new(jobs: usize, cpus: &[usize]) -> Self {
        static RUNS: AtomicU64 = AtomicU64::new(1);
        Self {
            entries: (0..jobs).map(|_| AtomicCell::new(Some(Box::default()))).collect(),
            collisions: AtomicU32::new(0),
            workers: AtomicU32::new(0),
            run: RUNS.fetch_add(1, Ordering::Relaxed),
            done: AtomicU64::new(0),
            pins: Pins { cpus: cpus.to_vec(), ..Pins::default() },
        }
    }

    /// The number of this thread, after `begin` if this is its first job.
    fn worker(&self, begin: impl FnOnce()) -> u32 {
        WORKER.with(|cell| {
            let (run, worker) = cell.get();
            if run == self.run {
                return worker;
            }
            begin();
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
        entry.span.worker = self.worker(|| self.pins.pin());
        entry.cpu = current_cpu();
        entry.span.start_s = start.elapsed().as_secs_f64();
        entry.counts = work();
        entry.span.stop_s = start.elapsed().as_secs_f64();
        entry.times_run += 1;
        self.entries[index].store(Some(entry));
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    /// Records the times of job `index`, which ran together with others on a device; `work` delivers its result. The
    /// thread that serves the device is no worker, and not pinned.
    pub(super) fn enter(&self, index: usize, [start_s, stop_s]: [f64; 2], work: impl FnOnce() -> Counts) {
        let Some(mut entry) = self.entries[index].take() else {
            self.collisions.fetch_add(1, Ordering::Relaxed);
            return;
        };
        entry.span = JobSpan { worker: self.worker(|| ()), start_s, stop_s };
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

    /// Fails if the system refused to pin a worker.
    pub(super) fn check_pins(&mut self) -> Result<()> {
        self.pins.failure.take().map_or(Ok(()), Err)
    }

    /// Takes the entries out, in index order. The error names a job that did not run exactly once.
    pub(super) fn close(&self) -> std::result::Result<Vec<Entry>, String> {
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

/// Times that a worker began a job on another processor than its job before; `None` if the system does not tell
/// processors, or no job ran here.
pub(super) fn migrations(entries: &[Entry]) -> Option<u64> {
    let mut jobs = Vec::with_capacity(entries.len());
    for Entry { span, cpu, .. } in entries {
        jobs.push((span.worker, span.start_s, (*cpu)?));
    }
    jobs.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let moved = jobs.windows(2).filter(|two| two[0].0 == two[1].0 && two[0].2 != two[1].2);
    Some(moved.count() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(worker: u32, start_s: f64, cpu: Option<u32>) -> Entry {
        Entry { span: JobSpan { worker, start_s, stop_s: start_s + 0.5 }, cpu, ..Entry::default() }
    }

    /// Worker 0 moves twice, from 3 to 4 and back; that worker 1 stays on another processor is no migration.
    #[test]
    fn migrations_are_counted_for_each_worker_in_the_order_of_its_jobs() {
        let entries = [(0, 2.0, 4), (1, 0.0, 7), (0, 0.0, 3), (0, 1.0, 3), (1, 5.0, 7), (0, 3.0, 3)]
            .map(|(w, s, c)| entry(w, s, Some(c)));
        assert_eq!(migrations(&entries), Some(2));
        assert_eq!(migrations(&[entries[0], entry(0, 9.0, None)]), None);
    }
}
