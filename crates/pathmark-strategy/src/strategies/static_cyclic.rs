//! Static cyclic: of p workers, worker w takes the jobs w, w + p, w + 2p, ...
//!
//! `pathmark render cornell --strategy static-cyclic --threads 4`
//!
//! The cyclic distribution of data-parallel languages, and OpenMP's `schedule(static, 1)`.
//!
//! Cost: one thread start for each worker and nothing for a job. It spreads an expensive region over all workers, so it
//! balances smooth costs well. It fails for costs that repeat with a period of p jobs.

use std::iter::StepBy;
use std::ops::Range;

use crate::Entry;

pub(super) const ENTRY: Entry =
    Entry::dealt("static-cyclic", "jobs dealt to the workers in turn, fixed beforehand", cycle);

/// Returns the jobs of `worker`: every `workers`-th job from its own number on. Each index has one remainder, so it
/// belongs to one worker.
fn cycle(worker: usize, workers: usize, jobs: usize) -> StepBy<Range<usize>> {
    (worker.min(jobs)..jobs).step_by(workers)
}
