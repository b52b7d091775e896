//! The host: a thread from the spawner that runs a library's parallel loop, while the thread that calls the strategy
//! only waits.
//!
//! Libraries whose calling thread takes part in the loop need a host. The host is then the first worker, and the
//! library's own threads are the others. It lives as long as the strategy, because some libraries keep their threads
//! for the thread that used them first.

use std::sync::Arc;

use crossbeam::channel::{self, Sender};

use crate::panics::Panics;
use crate::team::Crew;
use crate::{Blueprint, StrategyError};

type Round = Box<dyn FnOnce() + Send>;

/// A thread that runs a library's parallel loops. Fields are dropped in this order: closing the channel ends the
/// thread, which `_crew` then joins.
pub struct Host {
    rounds: Sender<Round>,
    _crew: Crew,
}

impl Host {
    /// Starts the thread as the first of the blueprint's workers.
    pub fn new(Blueprint { threads, spawner, .. }: &Blueprint) -> Result<Self, StrategyError> {
        let (rounds, calls) = channel::unbounded::<Round>();
        let mut crew = Crew::default();
        crew.hire(&**spawner, threads.get(), move || calls.into_iter().for_each(|round| round()))?;
        Ok(Self { rounds, _crew: crew })
    }

    /// Runs `body` on the thread, waits for its result and returns it. Re-raises a panic that `body` has thrown or
    /// caught.
    pub fn run<R: Send + 'static>(&self, body: impl FnOnce(&Panics) -> R + Send + 'static) -> R {
        let panics = Arc::new(Panics::default());
        let theirs = Arc::clone(&panics);
        let (tell, told) = channel::bounded(1);
        let round = Box::new(move || {
            let mut result = None;
            // `catch` drops the body, and with it this thread's last clone of the job.
            theirs.catch(|| result = Some(body(&theirs)));
            // Sending cannot fail: the caller waits for the result below.
            let _ = tell.send(result);
        });
        self.rounds.send(round).expect("the thread stays until this sender is dropped");
        let result = told.recv().expect("the thread answers each round");
        panics.raise();
        result.expect("a body that has not thrown has returned")
    }
}
