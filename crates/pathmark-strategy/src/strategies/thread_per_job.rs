//! Thread per job: a new thread for each job, all at once, and the operating system does the scheduling.
//!
//! `pathmark render cornell --strategy thread-per-job --decomposition rows`, or `--strategy thread-per-row` for short
//!
//! The method of report A (docs/reports.md), which starts 768 threads for the 768 rows of its image. It ignores
//! `--threads`.
//!
//! Cost: a thread start and end for each job (tens of microseconds), a stack for each, and time slices shared among far
//! more threads than cores. The kernel of the operating system balances the load. With tens of thousands of jobs the
//! system refuses threads or ends the process, so the number of jobs must stay below that.

use std::sync::Arc;

use crate::panics::Panics;
use crate::{Blueprint, Discipline, Entry, Job, StrategyError, Workers, each_run, team};

pub(super) const ENTRY: Entry = Entry {
    workers: Workers::PerJob,
    ..Entry::new(
        "thread-per-job",
        "a new thread for each job, all at once (ignores --threads)",
        Discipline::AllAtOnce,
        |blueprint| each_run(blueprint, run),
    )
};

fn run(blueprint: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let bodies = (0..jobs).map(|index| {
        let job = Arc::clone(job);
        move |panics: &Panics| {
            if !panics.stop_asked() {
                job(index);
            }
        }
    });
    team::run(&*blueprint.spawner, bodies)
}
