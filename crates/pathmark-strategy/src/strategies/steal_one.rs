//! Steal one: each worker has a block of jobs; a worker without jobs takes the last job of another worker.
//!
//! `pathmark render cornell --strategy steal-one:random --threads 4`; the victim is `neighbour` (the default), `random` or `richest`.
//!
//! Textbook work stealing, for loops: Blumofe and Leiserson, "Scheduling multithreaded computations by work stealing",
//! JACM 46(5), 1999, whose bounds are proved for random victims.
//!
//! Cost: one thread start for each worker and one compare-exchange for each job, on the worker's own cache line until
//! others steal from it. A thief returns after every job, so the last blocks to finish get much traffic.

use super::range_stealing::{discipline, entry};
use crate::{Amount, Entry};

pub(super) const ENTRY: Entry = entry(
    "steal-one",
    "blocks; an idle worker steals one job (steal-one:VICTIM; neighbour, random or richest)",
    Amount::One,
    |victim| discipline(Amount::One, victim),
);
