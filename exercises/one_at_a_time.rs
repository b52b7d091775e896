//! **Symptom.** The image is right, but two threads take as long as one, and the system shows one busy processor.
//!
//! **Hint.** How long does the guard live that `lock` returns in the head of `while let`?

use crate::prelude::*;

pub const ENTRY: Entry = Entry {
    threads: Threads::Library,
    ..Entry::new("one-at-a-time", "threads take jobs from a queue with a lock", Discipline::ONE_BY_ONE, |blueprint| {
        each_run(blueprint, run)
    })
};

fn run(pool: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let (queue, panics) = (Mutex::new((0..jobs).collect::<VecDeque<_>>()), Panics::default());
    on_threads(pool, jobs, || {
        while let Some(index) = queue.lock().unwrap_or_else(PoisonError::into_inner).pop_front() {
            panics.attempt(|| job(index));
        }
    });
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
