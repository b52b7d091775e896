//! What strategies with threads share: starting workers, waiting for all of them, and carrying a panic home.

use std::any::Any;
use std::mem;
use std::panic::{self, AssertUnwindSafe};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use super::{Spawner, StrategyError};

/// Runs each of `bodies` on a thread of its own and returns when all threads have ended.
///
/// A body must look at [`Panics::stop_asked`] between two jobs.
pub(super) fn run<B>(spawner: &dyn Spawner, bodies: impl ExactSizeIterator<Item = B>) -> Result<(), StrategyError>
where
    B: FnOnce(&Panics) + Send + 'static,
{
    let workers = bodies.len();
    let panics = Arc::new(Panics::default());
    let mut crew = Crew::default();
    let mut started = Ok(());
    for body in bodies {
        let theirs = Arc::clone(&panics);
        started = crew.hire(spawner, workers, move || theirs.catch(|| body(&theirs)));
        if started.is_err() {
            panics.ask_to_stop();
        }
        if panics.stop_asked() {
            break;
        }
    }
    drop(crew);
    panics.raise();
    started
}

/// Threads that are joined when this is dropped. Whatever makes them end must happen, or be dropped, before.
#[derive(Default)]
pub(super) struct Crew(Vec<JoinHandle<()>>);

impl Crew {
    /// Starts one more of `workers` threads.
    pub(super) fn hire(
        &mut self,
        spawner: &dyn Spawner,
        workers: usize,
        body: impl FnOnce() + Send + 'static,
    ) -> Result<(), StrategyError> {
        let worker = self.0.len() + 1;
        match spawner.spawn(format!("worker-{worker}"), Box::new(body)) {
            Ok(handle) => self.0.push(handle),
            Err(source) => return Err(StrategyError::Spawn { worker, workers, source }),
        }
        Ok(())
    }

    /// How many have been started.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }
}

impl Drop for Crew {
    fn drop(&mut self) {
        for handle in self.0.drain(..) {
            // Workers catch what their jobs throw, so that the payload is not tied to the thread's end: nothing is lost here.
            let _ = handle.join();
        }
    }
}

/// The first panic of one run, and the wish that everyone stop.
#[derive(Default)]
pub(super) struct Panics {
    stop: AtomicBool,
    first: Mutex<Option<Box<dyn Any + Send>>>,
}

impl Panics {
    /// Whether workers should take no further job.
    pub(super) fn stop_asked(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Lets no worker take a further job.
    pub(super) fn ask_to_stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Runs `body`; if it panics, asks everyone to stop, and keeps the payload if it is the first.
    pub(super) fn catch(&self, body: impl FnOnce()) {
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

    /// Goes on with the first panic, if there was one. All workers must have stopped.
    pub(super) fn raise(&self) {
        let first = self.first.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(payload) = first {
            panic::resume_unwind(payload);
        }
    }
}
