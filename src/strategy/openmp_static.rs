//! OpenMP, static: one contiguous block of jobs for each thread, dealt by libgomp.
//!
//! `pathmark render cornell --strategy openmp-static --threads 4`, in a build with `--features openmp`
//!
//! The `schedule(static)` of OpenMP: "OpenMP Application Programming Interface", version 5.2, 2021, section 11.5.3. It deals like
//! `static-blocks`, so what differs is who starts and wakes the threads.
//!
//! Cost: threads start once, at the first run. A run wakes them and ends with a barrier; a job is a call through C.

use super::openmp::{self, Schedule};
use super::{Config, Discipline, Entry, Sharing, Strategy, StrategyError, Threads, Workers, static_blocks, unless_set};

pub(super) const ENTRY: Entry = Entry {
    name: "openmp-static",
    about: "OpenMP's schedule(static) in libgomp: a block for each thread",
    workers: Workers::Threads,
    threads: Threads::Library,
    sharing: Sharing::AtOnce,
    discipline,
    new,
};

fn discipline(parameter: Option<&str>) -> Result<Discipline, StrategyError> {
    unless_set(ENTRY.name, parameter, Discipline::Dealt(static_blocks::deal))
}

fn new(config: Config) -> Result<Box<dyn Strategy>, StrategyError> {
    openmp::new(config, &ENTRY, Schedule::Static)
}
