//! Affinity: the processors on which the system may run a thread.

use super::system::{allowed_cpus, pin_thread};

/// The affinity of a thread, which it gets back when this is dropped.
pub struct KeptAffinity(Vec<usize>);

impl KeptAffinity {
    /// The affinity of this thread.
    pub fn of_thread() -> Self {
        Self(allowed_cpus())
    }
}

impl Drop for KeptAffinity {
    fn drop(&mut self) {
        if !self.0.is_empty() {
            // The thread had this affinity before, so a refusal means that the system has taken processors away.
            pin_thread(&self.0).ok();
        }
    }
}
