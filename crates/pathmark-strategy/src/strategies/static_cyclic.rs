//! Static cyclic: of p workers, worker w takes the jobs w, w + p, w + 2p, ...
//!
//! `pathmark render cornell --strategy static-cyclic --threads 4`
//!
//! The cyclic distribution of data-parallel languages, and OpenMP's `schedule(static, 1)`.
//!
//! Cost: one thread's start for each worker and nothing for a job. It spreads a dear region over all workers, so it balances
//! smooth costs well; costs that repeat with a period of p jobs defeat it.

use std::iter::StepBy;
use std::ops::Range;

use crate::Entry;

pub(super) const ENTRY: Entry =
    Entry::dealt("static-cyclic", "jobs dealt out to the workers like cards, fixed beforehand", cycle);

/// The jobs of `worker`: every `workers`-th from its own number on, so each index has one remainder and is in one worker's share.
fn cycle(worker: usize, workers: usize, jobs: usize) -> StepBy<Range<usize>> {
    (worker.min(jobs)..jobs).step_by(workers)
}
