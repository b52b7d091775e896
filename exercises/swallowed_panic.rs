//! **Symptom.** An assertion fails in one job. The terminal shows its message, but the program goes on, writes an image
//! with black rows, and ends with exit code 0.
//!
//! **Hint.** `join` returns the panic of a thread. [`Panics`] stops the other threads, too.

use crate::prelude::*;

pub const ENTRY: Entry = Entry {
    threads: Threads::Library,
    ..Entry::new("swallowed-panic", "threads share a counter", Discipline::ONE_BY_ONE, |blueprint| {
        each_run(blueprint, run)
    })
};

fn run(pool: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let next = Arc::new(AtomicUsize::new(0));
    let start = |_| {
        let (next, job) = (Arc::clone(&next), Arc::clone(job));
        thread::spawn(move || {
            while let Some(index) = take(&next, jobs) {
                job(index);
            }
        })
    };
    let threads: Vec<_> = (0..pool.workers(jobs)).map(start).collect();
    for thread in threads {
        thread.join().ok();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_keeps_the_contract() {
        crate::verify(&super::ENTRY).unwrap();
    }
}
