//! `--output row-progress`: as `slots`, but after each row of its piece a worker counts it under a lock that all workers share, as report B
//! (docs/reports.md) does to show its progress.
//!
//! Cost: one lock for each row of each piece. Report B also prints inside the lock, which is left out here.

use super::slots::Slots;
use super::{Entry, Output};
use crate::film::{Bounds, Film, Piece};
use crate::kernel::{Counts, Kernel};
use std::sync::{Mutex, PoisonError};

pub(super) const ENTRY: Entry = Entry {
    name: "row-progress",
    about: "like slots, plus a progress counter behind a lock after each row (report B)",
    new: |delivery| Ok(Box::new(RowProgress { slots: Slots::new(delivery)?, rows: Mutex::new(0) })),
};

struct RowProgress {
    slots: Slots,
    rows: Mutex<u64>,
}

impl Output for RowProgress {
    fn render(&self, index: usize, kernel: &dyn Kernel) -> Counts {
        let Piece { bounds, samples } = &self.slots.delivery.plan.pieces()[index];
        self.slots.fill(index, |tile| {
            let mut counts = Counts::default();
            for y in bounds.y0..bounds.y1 {
                let row = Piece { bounds: Bounds { y0: y, y1: y + 1, ..*bounds }, samples: samples.clone() };
                counts.add(&kernel.render(&row, tile));
                *self.rows.lock().unwrap_or_else(PoisonError::into_inner) += 1;
            }
            counts
        })
    }

    fn films(self: Box<Self>) -> Vec<Film> {
        Box::new(self.slots).films()
    }
}
