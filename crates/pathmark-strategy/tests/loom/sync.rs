//! What `src/sync.rs` names, as loom has it.

pub(super) use crossbeam::utils::CachePadded;
pub(super) use loom::sync::Mutex;
pub(super) use loom::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

/// Waiting, of which loom must be told, or it would try an endless loop to its end.
pub(super) struct Backoff(fn());

impl Backoff {
    pub(super) fn new() -> Self {
        Self(loom::thread::yield_now)
    }

    pub(super) fn snooze(&self) {
        (self.0)();
    }
}
