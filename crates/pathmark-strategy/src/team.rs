//! A team of threads: starting workers and waiting for all of them.

use std::sync::Arc;
use std::thread::JoinHandle;

use crate::panics::Panics;
use crate::{Spawner, StrategyError};

/// Runs each of `bodies` on its own thread and returns when all threads have ended.
///
/// A body must check [`Panics::stop_asked`] between two jobs.
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

/// Threads that are joined when this is dropped. The event that ends them must happen before.
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

    /// Returns the number of started threads.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }
}

impl Drop for Crew {
    fn drop(&mut self) {
        for handle in self.0.drain(..) {
            // Workers catch the panics of their jobs, so the thread's result holds no payload that could be lost here.
            let _ = handle.join();
        }
    }
}
