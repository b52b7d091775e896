//! A thread pool outside Pathmark: workers take turns at a counter under a lock.

use pathmark::strategy::{Blueprint, Discipline, Entry, Job, Panics, Strategy, StrategyError};
use std::sync::{Arc, Mutex, PoisonError};

pub const ENTRY: Entry =
    Entry::new("relay", "workers take turns at one counter under a lock", Discipline::ONE_BY_ONE, make);

fn make(blueprint: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    Ok(Box::new(Relay(blueprint.clone())))
}

struct Relay(Blueprint);

/// The state that a run's workers share.
struct Run {
    next: Mutex<usize>,
    panics: Panics,
}

impl Strategy for Relay {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let run = Arc::new(Run { next: Mutex::new(0), panics: Panics::default() });
        let workers = self.0.threads.get().min(jobs);
        let mut handles = Vec::new();
        let mut refused = None;
        for worker in 1..=workers {
            let (own_job, own_run) = (Arc::clone(&job), Arc::clone(&run));
            let body = Box::new(move || work(&own_run, jobs, &own_job));
            match self.0.spawner.spawn(format!("relay-{worker}"), body) {
                Ok(handle) => handles.push(handle),
                Err(source) => {
                    run.panics.ask_to_stop();
                    refused = Some(StrategyError::Spawn { worker, workers, source });
                    break;
                }
            }
        }
        for handle in handles {
            // Jobs' panics are caught; a worker itself does not panic.
            handle.join().ok();
        }
        drop(job);
        run.panics.raise();
        refused.map_or(Ok(()), Err)
    }
}

fn work(run: &Run, jobs: usize, job: &Job) {
    while !run.panics.stop_asked() {
        let index = {
            let mut next = run.next.lock().unwrap_or_else(PoisonError::into_inner);
            *next += 1;
            *next - 1
        };
        if index >= jobs {
            return;
        }
        run.panics.catch(|| job(index));
    }
}
