//! **Symptom.** In a container that limits the number of threads, a run with 8 threads takes as long as one with 2
//! elsewhere. Its row says 8 threads, and nothing fails.
//!
//! **Hint.** The system may refuse a thread. The caller must hear of it ([`StrategyError::Spawn`]), and the threads that
//! have started must end.

use crate::prelude::*;

pub const ENTRY: Entry =
    Entry::new("short-handed", "threads share a counter", Discipline::ONE_BY_ONE, |blueprint| each_run(blueprint, run));

fn run(pool: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let (next, panics) = (Arc::new(AtomicUsize::new(0)), Arc::new(Panics::default()));
    let mut threads = Vec::new();
    for worker in 0..pool.workers(jobs) {
        let (next, panics, job) = (Arc::clone(&next), Arc::clone(&panics), Arc::clone(job));
        let work = move || {
            while let Some(index) = take(&next, jobs) {
                panics.attempt(|| job(index));
            }
        };
        if let Ok(thread) = pool.spawner.spawn(format!("worker {worker}"), Box::new(work)) {
            threads.push(thread);
        }
    }
    for thread in threads {
        thread.join().ok();
    }
    panics.raise();
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_keeps_the_contract() {
        crate::verify(&super::ENTRY).unwrap();
    }
}
