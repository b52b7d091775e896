//! `--output locked`: one framebuffer behind one lock; each job renders for itself and then waits for its turn to copy.
//!
//! Cost: a buffer allocated in each job, and a lock that is held while a piece is copied. Large pieces hold it longer, small ones ask
//! for it more often.

use super::{Delivery, Entry, Output};
use crate::film::{Film, Sections, TileBuffer};
use crate::kernel::{Counts, Kernel};
use std::sync::{Mutex, MutexGuard, PoisonError};

pub(super) const ENTRY: Entry = Entry {
    name: "locked",
    about: "one framebuffer behind one lock",
    new: |delivery| {
        let film = Mutex::new(delivery.assembly());
        Box::new(Locked { delivery, film })
    },
};

struct Locked {
    delivery: Delivery,
    film: Mutex<Sections>,
}

impl Locked {
    /// Nothing can panic while the lock is held but a failed allocation, which ends the process.
    fn lock(&self) -> MutexGuard<'_, Sections> {
        self.film.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Output for Locked {
    fn render(&self, index: usize, kernel: &dyn Kernel) -> Counts {
        let piece = &self.delivery.plan.pieces()[index];
        let mut tile = TileBuffer::new(piece.bounds);
        let counts = kernel.render(piece, &mut tile);
        self.lock().add(&piece.samples, tile);
        counts
    }

    fn films(&self) -> Vec<Film> {
        let empty = Sections::new(0, 0, &[]);
        std::mem::replace(&mut *self.lock(), empty).finish()
    }
}
