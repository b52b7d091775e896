//! `--output shared-sum`: as `slots`, but each worker adds each of its pixels to one sum that all workers share. Wrong on
//! purpose: the mean of an image needs one addition for each worker, after its jobs.
//!
//! Cost: one lock for each pixel. The film does not come from the sum, so the image is right and only time is lost.

use super::slots::Slots;
use super::{Entry, Output};
use crate::film::{Bounds, Film, Piece};
use crate::kernel::{Counts, Kernel};
use std::sync::{Mutex, PoisonError};

pub(super) const ENTRY: Entry = Entry {
    name: "shared-sum",
    about: "wrong on purpose: like slots, plus a sum of all pixels behind a lock after each pixel",
    new: |delivery| Ok(Box::new(SharedSum { slots: Slots::new(delivery)?, sum: Mutex::new([0.0; 3]) })),
};

struct SharedSum {
    slots: Slots,
    /// The sum of the radiances of all samples.
    sum: Mutex<[f64; 3]>,
}

impl Output for SharedSum {
    fn render(&self, index: usize, kernel: &dyn Kernel) -> Counts {
        let Piece { bounds, samples } = &self.slots.delivery.plan.pieces()[index];
        self.slots.fill(index, |tile| {
            let mut counts = Counts::default();
            for y in bounds.y0..bounds.y1 {
                let row = Piece { bounds: Bounds { y0: y, y1: y + 1, ..*bounds }, samples: samples.clone() };
                counts.add(&kernel.render(&row, tile));
                for pixel in tile.row_mut(y) {
                    let mut sum = self.sum.lock().unwrap_or_else(PoisonError::into_inner);
                    sum.iter_mut().zip(pixel.sum).for_each(|(sum, own)| *sum += own);
                }
            }
            counts
        })
    }

    fn films(self: Box<Self>) -> Vec<Film> {
        Box::new(self.slots).films()
    }
}
