//! A pool of your own from the standard library alone: threads that share a counter.
//!
//! `cargo run --release --example custom_threads -- render cornell --strategy own-threads` renders with it, and
//! `cargo test --example custom_threads` says whether it keeps the contract.
//!
//! An [`Entry`] has a name, a description for `list strategies`, the discipline (how jobs are handed out, which the
//! simulator replays) and the function that makes the pool from a [`Blueprint`]: threads, and a spawner that starts them.
//! This pool keeps nothing between two runs, so the function [`run`] is all of it.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use pathmark::Lab;
use pathmark::strategy::{Blueprint, Discipline, Entry, Job, Panics, StrategyError, each_run};

const ENTRY: Entry =
    Entry::new("own-threads", "threads of the standard library share a counter", Discipline::ONE_BY_ONE, |blueprint| {
        each_run(blueprint, run)
    });

fn run(blueprint: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let (counter, panics) = (Arc::new(AtomicUsize::new(0)), Arc::new(Panics::default()));
    let workers = blueprint.workers(jobs);
    let (mut started, mut refused) = (Vec::new(), None);
    for worker in 0..workers {
        let (job, next, panics) = (Arc::clone(job), Arc::clone(&counter), Arc::clone(&panics));
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
        // Threads come from the spawner and not from `std::thread`, so that a test can refuse one.
        match blueprint.spawner.spawn(format!("worker {worker}"), Box::new(body)) {
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

fn main() -> ExitCode {
    pathmark::main(Lab::new().strategy(ENTRY))
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_keeps_the_contract() {
        pathmark::strategy::contract::verify(&super::ENTRY).unwrap();
    }
}
