//! `--output locked`: one framebuffer behind one lock; each job renders into its own buffer and then waits for its turn
//! to copy.
//!
//! Cost: a buffer allocated in each job, and a lock that is held while a piece is copied. Large pieces hold it longer, small ones ask
//! for it more often.

use super::{Delivery, Entry, Output};
use crate::film::{Film, Plan, Sections, TileBuffer};
use crate::kernel::{Counts, Kernel};
use std::sync::{Arc, Mutex, PoisonError};

pub(super) const ENTRY: Entry = Entry {
    name: "locked",
    about: "one framebuffer behind one lock",
    new: |Delivery { plan, films, .. }| Ok(Box::new(Locked { plan, films: Mutex::new(films) })),
};

struct Locked {
    plan: Arc<Plan>,
    films: Mutex<Sections>,
}

impl Output for Locked {
    fn render(&self, index: usize, kernel: &dyn Kernel) -> Counts {
        let piece = &self.plan.pieces()[index];
        let mut tile = TileBuffer::new(piece.bounds);
        let counts = kernel.render(piece, &mut tile);
        // Only a failed allocation could panic while the lock is held, and that ends the process.
        self.films.lock().unwrap_or_else(PoisonError::into_inner).add(&piece.samples, tile);
        counts
    }

    fn films(self: Box<Self>) -> Vec<Film> {
        self.films.into_inner().unwrap_or_else(PoisonError::into_inner).finish()
    }
}
