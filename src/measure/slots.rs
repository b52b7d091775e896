//! Where jobs put what they made: one slot a job, handed over by a pointer swap, so that no job waits for another.

use super::JobSpan;
use crate::film::{Plan, TileBuffer};
use crate::kernel::{Counts, Kernel};
use crossbeam::atomic::AtomicCell;
use std::cell::Cell;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::Instant;

/// What a job needs and what it leaves.
pub(super) struct Slot {
    pub(super) tile: TileBuffer,
    pub(super) counts: Counts,
    pub(super) span: JobSpan,
    pub(super) times_run: u32,
}

/// The slots of a run. A slot is empty while its job runs.
pub(super) struct Slots {
    cells: Vec<AtomicCell<Option<Box<Slot>>>>,
    /// Jobs that found their slot empty: somebody else was running them.
    collisions: AtomicU32,
    workers: AtomicU32,
    run: u64,
    /// Jobs done, for whoever shows progress.
    done: AtomicU64,
}

thread_local! {
    /// The run that this thread was last numbered in, and its number there: pools keep their threads over several runs.
    static WORKER: Cell<(u64, u32)> = const { Cell::new((0, 0)) };
}

impl Slots {
    /// Empty buffers for every piece: allocated and touched here, so that no job does.
    pub(super) fn new(plan: &Plan) -> Self {
        static RUNS: AtomicU64 = AtomicU64::new(1);
        let slot = |bounds| Slot {
            tile: TileBuffer::new(bounds),
            counts: Counts::default(),
            span: JobSpan::default(),
            times_run: 0,
        };
        Self {
            cells: plan.pieces().iter().map(|piece| AtomicCell::new(Some(Box::new(slot(piece.bounds))))).collect(),
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

    /// Runs job `index`: the body of every strategy's job.
    pub(super) fn fill(&self, index: usize, plan: &Plan, kernel: &dyn Kernel, start: Instant) {
        let Some(mut slot) = self.cells[index].take() else {
            self.collisions.fetch_add(1, Ordering::Relaxed);
            return;
        };
        slot.span.worker = self.worker();
        slot.span.start_s = start.elapsed().as_secs_f64();
        slot.counts = kernel.render(&plan.pieces()[index], &mut slot.tile);
        slot.span.stop_s = start.elapsed().as_secs_f64();
        slot.times_run += 1;
        self.cells[index].store(Some(slot));
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

    /// Takes the slots out, in index order; says which job did not run exactly once.
    pub(super) fn collect(&self) -> Result<Vec<Slot>, String> {
        let collisions = self.collisions.load(Ordering::Relaxed);
        if collisions > 0 {
            return Err(format!("{collisions} jobs were started while they were already running"));
        }
        let mut filled = Vec::with_capacity(self.cells.len());
        for (index, cell) in self.cells.iter().enumerate() {
            match cell.take() {
                Some(slot) if slot.times_run == 1 => filled.push(*slot),
                Some(slot) => return Err(format!("job {index} ran {} times instead of once", slot.times_run)),
                None => return Err(format!("job {index} did not finish")),
            }
        }
        Ok(filled)
    }
}
