//! **Symptom.** Some pixels at the bottom of the image are black, others in each run. With `sleep(1)` before the image is
//! written, all are there.
//!
//! **Hint.** What does the loop at the end of `run` wait for: that jobs were taken, or that they have ended?

use crate::prelude::*;

pub const ENTRY: Entry = Entry {
    threads: Threads::Library,
    ..Entry::new("early-return", "threads share a counter", Discipline::ONE_BY_ONE, |blueprint| {
        each_run(blueprint, run)
    })
};

fn run(pool: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let (next, panics) = (Arc::new(AtomicUsize::new(0)), Arc::new(Panics::default()));
    for _ in 0..pool.workers(jobs) {
        let (next, panics, job) = (Arc::clone(&next), Arc::clone(&panics), Arc::clone(job));
        thread::spawn(move || {
            while let Some(index) = take(&next, jobs) {
                panics.attempt(|| job(index));
            }
        });
    }
    while next.load(Ordering::Relaxed) < jobs {
        thread::yield_now();
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
