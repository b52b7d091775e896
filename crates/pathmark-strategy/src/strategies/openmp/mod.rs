//! The common part of the strategies on OpenMP: a loop of libgomp, the runtime that comes with GCC. Built with
//! `--features openmp`.
//!
//! The loop runs on a thread from the spawner, which OpenMP counts as the first of the team. libgomp starts the others
//! in the construction and keeps them; they end with the thread that leads them. After a loop they spin for a while
//! before they sleep (`OMP_WAIT_POLICY`), which slows down other threads on a busy machine.

mod ffi;

use std::ffi::c_int;
use std::sync::Arc;

pub(super) use ffi::Schedule;

use crate::{
    Blueprint, ChunkRule, Discipline, Entry, Handout, Host, Job, Parameter, Strategy, StrategyError, Threads, library,
};

/// Returns the entry of a strategy that hands out jobs as `discipline` says; `make` builds it on one of OpenMP's
/// schedules.
pub(super) const fn entry(
    name: &'static str,
    about: &'static str,
    discipline: Discipline,
    make: fn(&Blueprint) -> Result<Box<dyn Strategy>, StrategyError>,
) -> Entry {
    Entry { threads: Threads::Library, ..Entry::new(name, about, discipline, make) }
}

/// Returns the parameter of a schedule: the exact or the least number of jobs in a chunk.
pub(super) const fn chunk(read: fn(&str) -> Option<Discipline>) -> Option<Parameter> {
    Some(Parameter { allowed: "a number of jobs from 1 to 2147483647", read })
}

/// Parses the exact or the least number of jobs in a chunk, and returns the discipline of that schedule.
pub(super) fn chunks(size: fn(&Handout) -> usize, value: &str) -> Option<Discipline> {
    let chunk = value.parse::<c_int>().ok().filter(|chunk| *chunk > 0)?;
    Some(Discipline::Chunks(ChunkRule { size, parameter: chunk as usize }))
}

/// Makes a strategy on one of OpenMP's schedules.
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
        // All threads, even for few jobs: libgomp ends threads that a team does not use, and would start them anew.
        let (schedule, chunk, threads) = (self.schedule, self.chunk, self.threads);
        let team = self.host.run(move |panics| {
            let body = |index| panics.attempt(|| job(index));
            ffi::parallel_for(schedule, chunk, threads as c_int, jobs, &body) as usize
        });
        // The environment sets a limit, such as OMP_THREAD_LIMIT.
        if team < threads {
            return Err(StrategyError::TooManyThreads { strategy: self.strategy, threads, most: team });
        }
        Ok(())
    }
}
