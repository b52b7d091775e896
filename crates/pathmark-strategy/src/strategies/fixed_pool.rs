//! Fixed pool: workers that live as long as the strategy, fed with indices through one channel.
//!
//! `pathmark render cornell --strategy fixed-pool --threads 4`
//!
//! The thread pool of servers and the bag of tasks of Carriero and Gelernter ("How to write parallel programs", MIT
//! Press 1990): a queue from which any worker may take. The caller puts all indices in while the workers take them out.
//!
//! Cost: threads start once, in the construction and not in the run. A run wakes the workers. A job passes through a
//! `crossbeam` channel: two atomic updates on shared cache lines, and a parked worker to wake whenever the queue was
//! empty.

use std::sync::Arc;

use crossbeam::channel::{self, Receiver, Sender};
use crossbeam::sync::WaitGroup;

use crate::panics::Panics;
use crate::team::Crew;
use crate::{Blueprint, Discipline, Entry, Job, Strategy, StrategyError};

pub(super) const ENTRY: Entry = Entry::new(
    "fixed-pool",
    "a persistent pool whose workers receive indices through a channel",
    Discipline::ONE_BY_ONE,
    make,
);

fn make(Blueprint { threads, spawner, .. }: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    let threads = threads.get();
    // Declared before the sender, so dropped after it if a worker can't be started: the others then see the channel
    // close, and end.
    let mut crew = Crew::default();
    let (rounds, calls) = channel::unbounded::<Round>();
    for _ in 0..threads {
        let calls = calls.clone();
        crew.hire(&**spawner, threads, move || calls.into_iter().for_each(Round::work))?;
    }
    Ok(Box::new(FixedPool { rounds, crew }))
}

/// Capacity of the channel in indices: enough that workers seldom find it empty, without memory for 2^32 indices.
const QUEUE: usize = 4096;

/// Fields are dropped in this order: closing the channel ends the threads, which `crew` then joins.
struct FixedPool {
    rounds: Sender<Round>,
    crew: Crew,
}

/// A worker's share in one run.
struct Round {
    job: Job,
    indices: Receiver<usize>,
    panics: Arc<Panics>,
    done: WaitGroup,
}

impl Round {
    fn work(self) {
        let Self { job, indices, panics, done } = self;
        panics.catch(|| {
            for index in &indices {
                if panics.stop_asked() {
                    break;
                }
                job(index);
            }
        });
        // Dropped last, so that the waiting caller finds no clone of the job left here.
        drop((job, indices, panics));
        drop(done);
    }
}

impl Strategy for FixedPool {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let panics = Arc::new(Panics::default());
        let done = WaitGroup::new();
        let (feed, indices) = channel::bounded(jobs.min(QUEUE));
        // All workers take their rounds from one channel. A worker that has finished may take another worker's round.
        // That is harmless: a round ends only when no index is left and none can come.
        for _ in 0..self.crew.len().min(jobs) {
            let (job, indices) = (Arc::clone(&job), indices.clone());
            let round = Round { job, indices, panics: Arc::clone(&panics), done: done.clone() };
            self.rounds.send(round).expect("workers stay until this sender is dropped");
        }
        // Only workers may hold the receiving end. Otherwise sending would wait forever for room once they have
        // stopped.
        drop(indices);
        for index in 0..jobs {
            if feed.send(index).is_err() {
                break;
            }
        }
        drop(feed);
        done.wait();
        panics.raise();
        Ok(())
    }
}
