//! OpenMP, guided: a free worker takes 1/p of the jobs left, but at least C jobs, as computed by libgomp.
//!
//! `pathmark render cornell --strategy openmp-guided:4 --threads 4`, in a build with `--features openmp`; without a number C is 1.
//!
//! The `schedule(guided, C)` of OpenMP: "OpenMP Application Programming Interface", version 5.2, 2021, section 11.5.3.
//! The standard leaves the sizes to the implementation; libgomp rounds up, like `guided` and the paper cited there.
//!
//! Cost: threads start once, in the construction. A run wakes them and ends with a barrier. A chunk costs a
//! compare-exchange in libgomp, a job a call through C.

use super::guided;
use super::openmp::{Schedule, chunk, chunks, entry, make};
use crate::{Entry, Handout};

pub(super) const ENTRY: Entry = Entry {
    parameter: chunk(|value| chunks(size, value)),
    ..entry(
        "openmp-guided",
        "OpenMP's schedule(guided, C) in libgomp (openmp-guided:C; C is 1 by default)",
        guided::ENTRY.discipline,
        |blueprint| make(blueprint, Schedule::Guided),
    )
};

/// As `guided`, but at least C jobs.
fn size(handout: &Handout) -> usize {
    guided::size(handout).max(handout.parameter)
}
