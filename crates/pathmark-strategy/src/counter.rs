//! A counter from which all workers take numbers, each number once.
//!
//! This is the idea of self-scheduling: one atomic addition hands out the next job or chunk to any worker that asks.

use super::sync::{AtomicUsize, CachePadded, Ordering};

/// A counter that hands out 0, 1, 2 and so on.
#[derive(Default)]
pub(super) struct Counter {
    // Padded: otherwise taking a number would slow down readers of neighbouring data, such as the counts of an `Arc`.
    next: CachePadded<AtomicUsize>,
}

impl Counter {
    /// Returns the next number; no other caller gets it.
    pub(super) fn take(&self) -> usize {
        // Relaxed suffices: the counter shares only numbers. Joining the threads publishes the data that jobs write.
        self.next.fetch_add(1, Ordering::Relaxed)
    }
}
