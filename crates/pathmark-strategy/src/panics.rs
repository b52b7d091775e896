//! What jobs throw: the first payload is kept for the caller, and all workers are asked to stop.

use std::any::Any;
use std::mem;
use std::panic::{self, AssertUnwindSafe};
use std::sync::PoisonError;

use super::sync::{AtomicBool, Mutex, Ordering};

/// The first panic of one run, and the wish that everyone stop.
#[derive(Default)]
pub struct Panics {
    stop: AtomicBool,
    first: Mutex<Option<Box<dyn Any + Send>>>,
}

impl Panics {
    /// Whether workers should take no further job.
    pub fn stop_asked(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Lets no worker take a further job.
    pub fn ask_to_stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Runs `body`; if it panics, asks everyone to stop, and keeps the payload if it is the first.
    pub fn catch(&self, body: impl FnOnce()) {
        // Nobody sees what the job left half done: `raise` passes the panic on to whoever could.
        if let Err(payload) = panic::catch_unwind(AssertUnwindSafe(body)) {
            self.ask_to_stop();
            let mut first = self.first.lock().unwrap_or_else(PoisonError::into_inner);
            if first.is_none() {
                *first = Some(payload);
            } else {
                // Its `drop` is the job's code and could panic in turn, which would end a pool's worker for good. So it is leaked:
                // once a worker at most, in a run that has failed.
                mem::forget(payload);
            }
        }
    }

    /// One job of a worker that some library leads from job to job and that can't be told to stop: catches what the job throws, and
    /// leaves it out once a stop has been asked for.
    pub fn attempt(&self, job: impl FnOnce()) {
        if !self.stop_asked() {
            self.catch(job);
        }
    }

    /// Goes on with the first panic, if there was one. All workers must have stopped.
    pub fn raise(&self) {
        let first = self.first.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(payload) = first {
            panic::resume_unwind(payload);
        }
    }
}
