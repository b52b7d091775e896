//! Static cyclic: of p workers, worker w takes the jobs w, w + p, w + 2p, ...
//!
//! `pathmark render cornell --strategy static-cyclic --threads 4`
//!
//! The cyclic distribution of data-parallel languages, and OpenMP's `schedule(static, 1)`.
//!
//! Cost: one thread's start for each worker and nothing for a job. It spreads a dear region over all workers, so it balances
//! smooth costs well; costs that repeat with a period of p jobs defeat it.

use std::iter::StepBy;
use std::ops::Range;
use std::sync::Arc;

use super::panics::Panics;
use super::team;
use super::{Config, Discipline, Entry, Job, Sharing, Strategy, StrategyError, Threads, Workers, unless_set};

pub(super) const ENTRY: Entry = Entry {
    name: "static-cyclic",
    about: "jobs dealt out to the workers like cards, fixed beforehand",
    workers: Workers::Threads,
    threads: Threads::Spawner,
    sharing: Sharing::AtOnce,
    discipline,
    new,
};

fn discipline(parameter: Option<&str>) -> Result<Discipline, StrategyError> {
    unless_set(ENTRY.name, parameter, Discipline::Dealt(cycle))
}

fn new(config: Config) -> Result<Box<dyn Strategy>, StrategyError> {
    config.discipline(&ENTRY)?;
    Ok(Box::new(StaticCyclic(config)))
}

struct StaticCyclic(Config);

impl Strategy for StaticCyclic {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let workers = self.0.threads.get().min(jobs);
        let bodies = (0..workers).map(|worker| {
            let job = Arc::clone(&job);
            let mine = cycle(worker, workers, jobs);
            move |panics: &Panics| {
                for index in mine {
                    if panics.stop_asked() {
                        break;
                    }
                    job(index);
                }
            }
        });
        team::run(&*self.0.spawner, bodies)
    }
}

/// The jobs of `worker`: every `workers`-th from its own number on, so each index has one remainder and is in one worker's share.
fn cycle(worker: usize, workers: usize, jobs: usize) -> StepBy<Range<usize>> {
    (worker.min(jobs)..jobs).step_by(workers)
}
