//! Panics in jobs: the first payload is kept for the caller, and all workers are asked to stop.

use std::any::Any;
use std::mem;
use std::panic::{self, AssertUnwindSafe};
use std::sync::PoisonError;

use super::sync::{AtomicBool, Mutex, Ordering};

/// The first panic of one run, and the request that all workers stop.
#[derive(Default)]
pub struct Panics {
    stop: AtomicBool,
    first: Mutex<Option<Box<dyn Any + Send>>>,
}

impl Panics {
    /// Returns whether workers must take no further job.
    pub fn stop_asked(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Asks all workers to take no further job.
    pub fn ask_to_stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Runs `body`. If it panics, asks all workers to stop and keeps the payload if it is the first.
    pub fn catch(&self, body: impl FnOnce()) {
        // Unwind safe: `raise` passes the panic on to the caller, and nobody else can see the job's unfinished state.
        if let Err(payload) = panic::catch_unwind(AssertUnwindSafe(body)) {
            self.ask_to_stop();
            let mut first = self.first.lock().unwrap_or_else(PoisonError::into_inner);
            if first.is_none() {
                *first = Some(payload);
            } else {
                // The payload's `drop` is the job's code. It could panic, too, and end a pool's worker for good. So the
                // payload is leaked: at most one for each worker, in a run that has failed.
                mem::forget(payload);
            }
        }
    }

    /// Runs a job for a library whose workers cannot be told to stop: catches a panic of the job, and skips the job
    /// once a stop has been requested.
    pub fn attempt(&self, job: impl FnOnce()) {
        if !self.stop_asked() {
            self.catch(job);
        }
    }

    /// Raises the first panic again, if there was one. All workers must have stopped.
    pub fn raise(&self) {
        let first = self.first.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(payload) = first {
            panic::resume_unwind(payload);
        }
    }
}
