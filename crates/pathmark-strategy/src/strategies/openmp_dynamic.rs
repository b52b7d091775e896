//! OpenMP, dynamic: a free worker takes the next C jobs, from a counter of libgomp.
//!
//! `pathmark render cornell --strategy openmp-dynamic:8 --threads 4`, in a build with `--features openmp`; without a number C is 1.
//!
//! The `schedule(dynamic, C)` of OpenMP: "OpenMP Application Programming Interface", version 5.2, 2021, section 11.5.3.
//! smallpt uses this schedule with one row of pixels as a chunk. It hands out jobs like `dynamic`.
//!
//! Cost: threads start once, in the construction. A run wakes them and ends with a barrier. A chunk costs an atomic
//! addition in libgomp, a job a call through C.

use super::dynamic;
use super::openmp::{Schedule, chunk, chunks, entry, make};
use crate::Entry;

pub(super) const ENTRY: Entry = Entry {
    parameter: chunk(|value| chunks(dynamic::size, value)),
    ..entry(
        "openmp-dynamic",
        "OpenMP's schedule(dynamic, C) in libgomp (openmp-dynamic:C; C is 1 by default)",
        dynamic::ENTRY.discipline,
        |blueprint| make(blueprint, Schedule::Dynamic),
    )
};
