//! Serial: one job after the other on the calling thread.
//!
//! `pathmark render cornell --strategy serial`
//!
//! The baseline T1 of every speedup: the best that one thread can achieve. It starts no thread and synchronises
//! nothing. So a parallel strategy on one thread is measured *against* it, not instead of it.
//!
//! Cost: an indirect call for each job.

use crate::{Blueprint, Discipline, Entry, Job, StrategyError, Workers, each_run};

pub(super) const ENTRY: Entry = Entry {
    workers: Workers::Caller,
    ..Entry::new(
        "serial",
        "one job after the other on the calling thread: the baseline of speedups (ignores --threads)",
        Discipline::InOrder,
        |blueprint| each_run(blueprint, run),
    )
};

fn run(_: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    for index in 0..jobs {
        job(index);
    }
    Ok(())
}
