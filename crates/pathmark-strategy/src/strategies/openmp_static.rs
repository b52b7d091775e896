//! OpenMP, static: one contiguous block of jobs for each thread, dealt by libgomp.
//!
//! `pathmark render cornell --strategy openmp-static --threads 4`, in a build with `--features openmp`
//!
//! The `schedule(static)` of OpenMP: "OpenMP Application Programming Interface", version 5.2, 2021, section 11.5.3. It
//! deals jobs like `static-blocks`; only the starting and waking of threads differs.
//!
//! Cost: threads start once, in the construction. A run wakes them and ends with a barrier. A job costs a call through
//! C.

use super::openmp::{Schedule, entry, make};
use super::static_blocks;
use crate::{Discipline, Entry};

pub(super) const ENTRY: Entry = entry(
    "openmp-static",
    "OpenMP's schedule(static) in libgomp: a block for each thread",
    Discipline::Dealt(static_blocks::deal),
    |blueprint| make(blueprint, Schedule::Static),
);
