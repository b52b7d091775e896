//! The pool: threads of the standard library that share a counter. Put yours in its place.

use pathmark::strategy::{Blueprint, Discipline, Entry, Job, Panics, Spawner, Strategy, StrategyError};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

pub const ENTRY: Entry = Entry::new("my-pool", "threads that share a counter", Discipline::ONE_BY_ONE, make);

fn make(blueprint: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    // Threads come from the spawner and not from `std::thread`, so that the contract's test can refuse one.
    Ok(Box::new(MyPool { threads: blueprint.threads.get(), spawner: Arc::clone(&blueprint.spawner) }))
}

struct MyPool {
    threads: usize,
    spawner: Arc<dyn Spawner>,
}

impl Strategy for MyPool {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let (counter, panics) = (Arc::new(AtomicUsize::new(0)), Arc::new(Panics::default()));
        let workers = self.threads.min(jobs);
        let (mut started, mut refused) = (Vec::new(), None);
        for worker in 0..workers {
            let (job, next, panics) = (Arc::clone(&job), Arc::clone(&counter), Arc::clone(&panics));
            let body = move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= jobs {
                        break;
                    }
                    // After a panic the remaining jobs are skipped.
                    panics.attempt(|| job(index));
                }
            };
            match self.spawner.spawn(format!("worker {worker}"), Box::new(body)) {
                Ok(thread) => started.push(thread),
                Err(source) => {
                    // The system refused a thread: the others find no more jobs, and the caller hears of it.
                    counter.store(jobs, Ordering::Relaxed);
                    refused = Some(StrategyError::Spawn { worker: worker + 1, workers, source });
                    break;
                }
            }
        }
        for thread in started {
            // A job's panic is caught within it, so a thread does not panic.
            thread.join().ok();
        }
        panics.raise();
        refused.map_or(Ok(()), Err)
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_keeps_the_contract() {
        pathmark::strategy::contract::verify(&super::ENTRY).unwrap();
    }
}
