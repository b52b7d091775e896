//! A queue of job indices behind one lock.

use std::collections::VecDeque;
use std::sync::PoisonError;

use super::sync::Mutex;

/// The indices that no worker has taken yet.
pub(super) struct LockedQueue(Mutex<VecDeque<usize>>);

impl LockedQueue {
    /// Returns a queue of all of `0..jobs`, in order.
    pub(super) fn new(jobs: usize) -> Self {
        Self(Mutex::new((0..jobs).collect()))
    }

    /// Takes the first index. The lock is released on return, so no job runs under it.
    pub(super) fn take(&self) -> Option<usize> {
        // Nothing that can panic happens under the lock.
        self.0.lock().unwrap_or_else(PoisonError::into_inner).pop_front()
    }
}
