//! Static cyclic: of p workers, worker w takes the jobs w, w + p, w + 2p, ...
//!
//! `pathmark render cornell --strategy static-cyclic --threads 4`
//!
//! The cyclic distribution of data-parallel languages, and OpenMP's `schedule(static, 1)`.
//!
//! Cost: one thread's start for each worker and nothing for a job. It spreads a dear region over all workers, so it balances
//! smooth costs well; costs that repeat with a period of p jobs defeat it.

use std::sync::Arc;

use super::team::{self, Panics};
use super::{Config, Entry, Job, Strategy, StrategyError, Workers};

pub(super) const ENTRY: Entry = Entry {
    name: "static-cyclic",
    about: "jobs dealt out to the workers like cards, fixed beforehand",
    workers: Workers::Threads,
    new,
};

fn new(config: Config) -> Result<Box<dyn Strategy>, StrategyError> {
    Ok(Box::new(StaticCyclic(config.without_parameter(ENTRY.name)?)))
}

struct StaticCyclic(Config);

impl Strategy for StaticCyclic {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let workers = self.0.threads.get().min(jobs);
        let bodies = (0..workers).map(|worker| {
            let job = Arc::clone(&job);
            move |panics: &Panics| {
                for index in (worker..jobs).step_by(workers) {
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
