//! **Symptom.** Images of up to 100 rows are right. With more rows the program never ends, and it uses no processor.
//!
//! **Hint.** A bounded channel blocks its sender while it is full. Who could empty it?

use crate::prelude::*;

pub const ENTRY: Entry = Entry {
    threads: Threads::Library,
    ..Entry::new("stuck-queue", "threads take jobs from a channel", Discipline::ONE_BY_ONE, |blueprint| {
        each_run(blueprint, run)
    })
};

fn run(pool: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let (sender, receiver) = mpsc::sync_channel(100);
    let (queue, panics) = (Mutex::new(receiver), Panics::default());
    (0..jobs).try_for_each(|index| sender.send(index)).expect("the receiver lives");
    drop(sender);
    on_threads(pool, jobs, || {
        loop {
            let next = queue.lock().unwrap_or_else(PoisonError::into_inner).recv();
            let Ok(index) = next else { break };
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
