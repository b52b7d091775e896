//! Steal half: each worker has its block of the jobs, and whoever is done takes the upper half of what another has left.
//!
//! `pathmark render cornell --strategy steal-half:richest --threads 4`; the victim is `neighbour` (the default), `random` or `richest`.
//!
//! Hendler and Shavit, "Non-blocking steal-half work queues", PODC 2002. Their queues hold tasks of any kind; jobs that are numbers in a row
//! need no queue, and a compare-exchange of the range's two ends takes half of it.
//!
//! Cost: one thread's start for each worker and one compare-exchange for each job, on the worker's own cache line until others steal from
//! it. A block that is too dear is spread in about log2(n) thefts, where `steal-one` needs one for each job.

use super::range_stealing::{discipline, entry};
use crate::{Amount, Entry};

pub(super) const ENTRY: Entry = entry(
    "steal-half",
    "blocks; whoever is done steals half of a block (steal-half:VICTIM; neighbour, random or richest)",
    Amount::Half,
    |victim| discipline(Amount::Half, victim),
);
