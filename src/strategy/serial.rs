//! Serial: one job after the other on the calling thread.
//!
//! `pathmark render cornell --strategy serial`
//!
//! The baseline T1 of every speedup: the best that one thread can do. It starts nothing and synchronises nothing, so a parallel
//! strategy on one thread is measured *against* it, not instead of it.
//!
//! Cost: an indirect call a job.

use super::{Config, Discipline, Entry, Job, Sharing, Strategy, StrategyError, Threads, Workers, unless_set};

pub(super) const ENTRY: Entry = Entry {
    name: "serial",
    about: "one job after the other on the calling thread: the baseline of speedups (ignores --threads)",
    workers: Workers::Caller,
    threads: Threads::Spawner,
    sharing: Sharing::AtOnce,
    discipline,
    new,
};

fn discipline(parameter: Option<&str>) -> Result<Discipline, StrategyError> {
    unless_set(ENTRY.name, parameter, Discipline::InOrder)
}

fn new(Config { parameter, .. }: Config) -> Result<Box<dyn Strategy>, StrategyError> {
    discipline(parameter.as_deref())?;
    Ok(Box::new(Serial))
}

struct Serial;

impl Strategy for Serial {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        for index in 0..jobs {
            job(index);
        }
        Ok(())
    }
}
