//! A thread from the spawner on which a library's parallel loop runs, so that the thread that calls the strategy only waits.
//!
//! Libraries that let the calling thread take part need one: this thread is then the first of the workers, and the library's own threads
//! are the others. It lives as long as the strategy, since some libraries keep their threads for whoever used them first.

use std::sync::Arc;

use crossbeam::channel::{self, Sender};

use crate::panics::Panics;
use crate::team::Crew;
use crate::{Blueprint, StrategyError};

type Round = Box<dyn FnOnce() + Send>;

/// Fields are dropped in this order: the closed channel is what ends the thread that `_crew` then waits for.
pub struct Host {
    rounds: Sender<Round>,
    _crew: Crew,
}

impl Host {
    /// Starts the first of so many workers.
    pub fn new(Blueprint { threads, spawner, .. }: &Blueprint) -> Result<Self, StrategyError> {
        let (rounds, calls) = channel::unbounded::<Round>();
        let mut crew = Crew::default();
        crew.hire(&**spawner, threads.get(), move || calls.into_iter().for_each(|round| round()))?;
        Ok(Self { rounds, _crew: crew })
    }

    /// Runs `body` on the thread, waits for its end, and passes on what it has thrown or caught.
    pub fn run<R: Send + 'static>(&self, body: impl FnOnce(&Panics) -> R + Send + 'static) -> R {
        let panics = Arc::new(Panics::default());
        let theirs = Arc::clone(&panics);
        let (tell, told) = channel::bounded(1);
        let round = Box::new(move || {
            let mut result = None;
            // The body is gone when this returns, and with it the last clone of the job over there.
            theirs.catch(|| result = Some(body(&theirs)));
            // It is waited for: the caller is below.
            let _ = tell.send(result);
        });
        self.rounds.send(round).expect("the thread stays until this sender is dropped");
        let result = told.recv().expect("the thread answers each round");
        panics.raise();
        result.expect("a body that has not thrown has returned")
    }
}
