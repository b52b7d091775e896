//! Steal half: each worker has its block of the jobs, and whoever is done takes the upper half of what another has left.
//!
//! `pathmark render cornell --strategy steal-half:richest --threads 4`; the victim is `neighbour` (the default), `random` or `richest`.
//!
//! Hendler and Shavit, "Non-blocking steal-half work queues", PODC 2002. Their queues hold tasks of any kind; jobs that are numbers in a row
//! need no queue, and a compare-exchange of the range's two ends takes half of it.
//!
//! Cost: one thread's start for each worker and one compare-exchange for each job, on the worker's own cache line until others steal from
//! it. A block that is too dear is spread in about log2(n) thefts, where `steal-one` needs one for each job.

use super::{Amount, Config, Discipline, Entry, Sharing, Strategy, StrategyError, Threads, Workers, range_stealing};

pub(super) const ENTRY: Entry = Entry {
    name: "steal-half",
    about: "blocks; whoever is done steals half of a block (steal-half:VICTIM; neighbour, random or richest)",
    workers: Workers::Threads,
    threads: Threads::Spawner,
    sharing: Sharing::AtOnce,
    discipline,
    new,
};

fn discipline(parameter: Option<&str>) -> Result<Discipline, StrategyError> {
    range_stealing::discipline(ENTRY.name, Amount::Half, parameter)
}

fn new(config: Config) -> Result<Box<dyn Strategy>, StrategyError> {
    range_stealing::new(config, &ENTRY)
}
