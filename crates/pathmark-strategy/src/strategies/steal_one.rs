//! Steal one: each worker has its block of the jobs, and whoever is done takes the last job of another.
//!
//! `pathmark render cornell --strategy steal-one:random --threads 4`; the victim is `neighbour` (the default), `random` or `richest`.
//!
//! Work stealing in its textbook form, on loops: Blumofe and Leiserson, "Scheduling multithreaded computations by work stealing", JACM 46(5),
//! 1999, where random victims are what the bounds are proved for.
//!
//! Cost: one thread's start for each worker and one compare-exchange for each job, on the worker's own cache line until others steal from
//! it. A thief comes back after every job, so the last blocks to finish see much traffic.

use super::range_stealing::{discipline, entry};
use crate::{Amount, Entry};

pub(super) const ENTRY: Entry = entry(
    "steal-one",
    "blocks; whoever is done steals one job (steal-one:VICTIM; neighbour, random or richest)",
    Amount::One,
    |victim| discipline(Amount::One, victim),
);
