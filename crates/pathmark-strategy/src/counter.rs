//! A counter from which all workers take numbers, each number once.
//!
//! Its shape is the whole idea of self-scheduling: one atomic addition hands out the next piece of work, whoever asks.

use super::sync::{AtomicUsize, CachePadded, Ordering};

/// Hands out 0, 1, 2 and so on.
#[derive(Default)]
pub(super) struct Counter {
    // Padded, so that taking a number doesn't slow down whoever reads the neighbours, the counts of an `Arc` among them.
    next: CachePadded<AtomicUsize>,
}

impl Counter {
    /// The next number, which nobody else gets.
    pub(super) fn take(&self) -> usize {
        // Relaxed: numbers alone are shared out here; what jobs write is published by joining the threads.
        self.next.fetch_add(1, Ordering::Relaxed)
    }
}
