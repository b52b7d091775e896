//! What the strategies on OpenMP share: a loop of libgomp, the runtime that comes with GCC. Built with `--features openmp`.
//!
//! The loop runs on a thread from the spawner, which OpenMP counts as the first of the team; libgomp starts the others in the construction and
//! keeps them. They end with the thread that leads them. When a loop is done they spin for a while before they sleep (`OMP_WAIT_POLICY`),
//! which costs whoever runs next on a busy machine.

mod ffi;

use std::ffi::c_int;
use std::sync::Arc;

pub(super) use ffi::Schedule;

use crate::{
    Blueprint, ChunkRule, Discipline, Entry, Handout, Host, Job, Parameter, Strategy, StrategyError, Threads, library,
};

/// The strategy that hands out jobs as `discipline` says; `make` makes it from one of OpenMP's schedules.
pub(super) const fn entry(
    name: &'static str,
    about: &'static str,
    discipline: Discipline,
    make: fn(&Blueprint) -> Result<Box<dyn Strategy>, StrategyError>,
) -> Entry {
    Entry { threads: Threads::Library, ..Entry::new(name, about, discipline, make) }
}

/// What may be set of a schedule with chunks of at least, or exactly, so many jobs.
pub(super) const fn chunk(read: fn(&str) -> Option<Discipline>) -> Option<Parameter> {
    Some(Parameter { allowed: "a number of jobs from 1 to 2147483647", read })
}

/// A schedule with chunks of at least, or exactly, so many jobs as the parameter says.
pub(super) fn chunks(size: fn(&Handout) -> usize, value: &str) -> Option<Discipline> {
    let chunk = value.parse::<c_int>().ok().filter(|chunk| *chunk > 0)?;
    Some(Discipline::Chunks(ChunkRule { size, parameter: chunk as usize }))
}

/// A strategy that is one of OpenMP's schedules.
pub(super) fn make(blueprint: &Blueprint, schedule: Schedule) -> Result<Box<dyn Strategy>, StrategyError> {
    let chunk = match blueprint.discipline {
        Discipline::Chunks(rule) => rule.parameter as c_int,
        _ => 0,
    };
    let (strategy, threads, most) = (blueprint.strategy, blueprint.threads.get(), c_int::MAX as usize);
    if threads > most {
        return Err(StrategyError::TooManyThreads { strategy, threads, most });
    }
    // If the system refuses one of its threads, libgomp ends the program.
    library::rehearse(blueprint, threads)?;
    let mut openmp = OpenMp { strategy, host: Host::new(blueprint)?, schedule, chunk, threads };
    openmp.run(0, Arc::new(|_| ()))?;
    Ok(Box::new(openmp))
}

struct OpenMp {
    strategy: &'static str,
    host: Host,
    schedule: Schedule,
    chunk: c_int,
    threads: usize,
}

impl Strategy for OpenMp {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        // All of them, however few jobs there are: libgomp ends threads that a team has no use for, and would start them anew.
        let (schedule, chunk, threads) = (self.schedule, self.chunk, self.threads);
        let team = self.host.run(move |panics| {
            let body = |index| panics.attempt(|| job(index));
            ffi::parallel_for(schedule, chunk, threads as c_int, jobs, &body) as usize
        });
        // A limit in the environment, such as OMP_THREAD_LIMIT.
        if team < threads {
            return Err(StrategyError::TooManyThreads { strategy: self.strategy, threads, most: team });
        }
        Ok(())
    }
}
