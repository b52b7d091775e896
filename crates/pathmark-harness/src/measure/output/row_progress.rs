//! `--output row-progress`: as `slots`, but after each row of its piece a worker counts it under a lock that all workers share, as report B
//! (docs/reports.md) does to show its progress.
//!
//! Cost: one lock for each row of each piece. Report B also prints inside the lock: `printed-progress`.

use super::slots::Slots;
use super::{Delivery, Entry, Output};
use crate::error::Result;
use crate::film::{Bounds, Film, Piece};
use crate::kernel::{Counts, Kernel};
use std::fs::File;
use std::io::Write;
use std::sync::{Mutex, PoisonError};

/// Characters of a full progress bar.
const BAR: u64 = 70;

pub(super) const ENTRY: Entry = Entry {
    name: "row-progress",
    about: "like slots, plus a progress counter behind a lock after each row (report B)",
    new: |delivery| Ok(Box::new(RowProgress::new(delivery, None)?)),
};

/// The rows that all workers have finished, and where they are shown.
struct Progress {
    rows: u64,
    all: u64,
    shown: Option<File>,
}

pub(super) struct RowProgress {
    slots: Slots,
    progress: Mutex<Progress>,
}

impl RowProgress {
    /// Counts rows, and shows their share in a file if there is one.
    pub(super) fn new(delivery: Delivery, shown: Option<File>) -> Result<Self> {
        let all = delivery.plan.pieces().iter().map(|piece| u64::from(piece.bounds.height())).sum();
        Ok(Self { slots: Slots::new(delivery)?, progress: Mutex::new(Progress { rows: 0, all, shown }) })
    }

    fn count(&self) {
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.rows += 1;
        let Progress { rows, all, shown: Some(shown) } = &mut *progress else { return };
        let filled = (BAR * *rows / *all) as usize;
        let bar = format!("[{}>{}] {} %\r", "=".repeat(filled), " ".repeat(BAR as usize - filled), 100 * *rows / *all);
        // A bar that cannot be shown is no reason to end a render.
        let _ = shown.write_all(bar.as_bytes());
    }
}

impl Output for RowProgress {
    fn render(&self, index: usize, kernel: &dyn Kernel) -> Counts {
        let Piece { bounds, samples } = &self.slots.delivery.plan.pieces()[index];
        self.slots.fill(index, |tile| {
            let mut counts = Counts::default();
            for y in bounds.y0..bounds.y1 {
                let row = Piece { bounds: Bounds { y0: y, y1: y + 1, ..*bounds }, samples: samples.clone() };
                counts.add(&kernel.render(&row, tile));
                self.count();
            }
            counts
        })
    }

    fn films(self: Box<Self>) -> Vec<Film> {
        Box::new(self.slots).films()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Decomposition, Sections};
    use std::io::{Read, Seek};
    use std::slice::from_ref;
    use std::sync::Arc;

    #[test]
    fn each_row_shows_a_bar_and_the_last_one_is_full() {
        let samples = 0..1;
        let plan = Arc::new(Decomposition::parse("bands:2").unwrap().plan(8, 4, &samples));
        let films = Sections::new(8, 4, from_ref(&samples)).unwrap();
        let mut shown = tempfile::tempfile().unwrap();
        let delivery = Delivery { plan, films, threads: 1 };
        let progress = RowProgress::new(delivery, Some(shown.try_clone().unwrap())).unwrap();
        (0..4).for_each(|_| progress.count());
        let mut text = String::new();
        shown.rewind().unwrap();
        shown.read_to_string(&mut text).unwrap();
        let bars: Vec<&str> = text.split_terminator('\r').collect();
        assert_eq!(
            bars.iter().map(|bar| bar.split("] ").nth(1).unwrap()).collect::<Vec<_>>(),
            ["25 %", "50 %", "75 %", "100 %"]
        );
        assert_eq!(bars[1], format!("[{}>{}] 50 %", "=".repeat(35), " ".repeat(35)));
        assert_eq!(bars[3], format!("[{}>] 100 %", "=".repeat(70)));
    }
}
