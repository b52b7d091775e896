//! What the strategies on OpenMP share: a loop of libgomp, the runtime that comes with GCC. Built with `--features openmp`.
//!
//! The loop runs on a thread from the spawner, which OpenMP counts as the first of the team; libgomp starts the others at the first run and
//! keeps them. They end with the thread that leads them. When a loop is done they spin for a while before they sleep (`OMP_WAIT_POLICY`),
//! which costs whoever runs next on a busy machine.

mod ffi;

use std::ffi::c_int;

pub(super) use ffi::Schedule;

use super::host::Host;
use super::{ChunkRule, Config, Discipline, Entry, Handout, Job, Strategy, StrategyError};

/// The discipline of a schedule with chunks of at least, or exactly, so many jobs as the parameter says; 1 if it says nothing.
pub(super) fn chunks(
    strategy: &'static str,
    size: fn(&Handout) -> usize,
    parameter: Option<&str>,
) -> Result<Discipline, StrategyError> {
    let text = parameter.unwrap_or("1");
    match text.parse::<c_int>() {
        Ok(chunk) if chunk > 0 => Ok(Discipline::Chunks(ChunkRule { size, parameter: chunk as usize })),
        _ => Err(StrategyError::Parameter {
            strategy,
            value: text.to_owned(),
            allowed: format!("a number of jobs from 1 to {}", c_int::MAX),
        }),
    }
}

/// The strategy of an entry that is one of OpenMP's schedules.
pub(super) fn new(config: Config, entry: &Entry, schedule: Schedule) -> Result<Box<dyn Strategy>, StrategyError> {
    let chunk = match config.discipline(entry)? {
        Discipline::Chunks(rule) => rule.parameter as c_int,
        _ => 0,
    };
    let (threads, most) = (config.threads.get(), c_int::MAX as usize);
    if threads > most {
        return Err(StrategyError::TooManyThreads { strategy: entry.name, threads, most });
    }
    Ok(Box::new(OpenMp { name: entry.name, host: Host::new(config)?, schedule, chunk, threads }))
}

struct OpenMp {
    name: &'static str,
    host: Host,
    schedule: Schedule,
    chunk: c_int,
    threads: usize,
}

impl Strategy for OpenMp {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let (schedule, chunk, threads) = (self.schedule, self.chunk, self.threads.min(jobs.max(1)));
        let team = self.host.run(move |panics| {
            let body = |index| panics.attempt(|| job(index));
            ffi::parallel_for(schedule, chunk, threads as c_int, jobs, &body) as usize
        });
        // A limit in the environment, such as OMP_THREAD_LIMIT.
        if team < threads {
            return Err(StrategyError::TooManyThreads { strategy: self.name, threads, most: team });
        }
        Ok(())
    }
}
