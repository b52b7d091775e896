//! **Symptom.** An image of 120 rows is right. With 121 rows, the last row is black, whatever the number of threads.
//!
//! **Hint.** Threads take four jobs at a time. Follow the last jobs when their number is no multiple of four.

use crate::prelude::*;

pub const CHUNK: usize = 4;

pub const ENTRY: Entry = Entry {
    threads: Threads::Library,
    ..Entry::new(
        "lost-job",
        "threads take four jobs at a time",
        Discipline::Chunks(ChunkRule { size: |_| CHUNK, parameter: 1 }),
        |blueprint| each_run(blueprint, run),
    )
};

fn run(pool: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let (next, panics) = (AtomicUsize::new(0), Panics::default());
    on_threads(pool, jobs, || {
        loop {
            let start = next.fetch_add(CHUNK, Ordering::Relaxed);
            if start + CHUNK > jobs {
                break;
            }
            (start..start + CHUNK).for_each(|index| panics.attempt(|| job(index)));
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
