//! Steal half: each worker has a block of jobs; a worker without jobs takes the upper half of another worker's jobs.
//!
//! `pathmark render cornell --strategy steal-half:richest --threads 4`; the victim is `neighbour` (the default), `random` or `richest`.
//!
//! Hendler and Shavit, "Non-blocking steal-half work queues", PODC 2002. Their queues hold arbitrary tasks. Jobs that
//! are consecutive numbers need no queue: one compare-exchange of the range's two ends takes half of it.
//!
//! Cost: one thread start for each worker and one compare-exchange for each job, on the worker's own cache line until
//! others steal from it. An expensive block is spread in about log2(n) thefts, where `steal-one` needs one for each
//! job.

use super::range_stealing::{discipline, entry};
use crate::{Amount, Entry};

pub(super) const ENTRY: Entry = entry(
    "steal-half",
    "blocks; an idle worker steals half of a block (steal-half:VICTIM; neighbour, random or richest)",
    Amount::Half,
    |victim| discipline(Amount::Half, victim),
);
