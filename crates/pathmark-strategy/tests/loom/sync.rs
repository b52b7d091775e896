//! The names of `src/sync.rs`, with loom's types.

pub(super) use crossbeam::utils::CachePadded;
pub(super) use loom::sync::Mutex;
pub(super) use loom::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

/// A wait that yields to loom; otherwise loom would follow an endless loop.
pub(super) struct Backoff(fn());

impl Backoff {
    pub(super) fn new() -> Self {
        Self(loom::thread::yield_now)
    }

    pub(super) fn snooze(&self) {
        (self.0)();
    }
}
