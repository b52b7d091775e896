//! Rayon's join: the range of jobs is halved by our own recursion, down to single jobs.
//!
//! `pathmark render cornell --strategy rayon-join --threads 4`
//!
//! Divide and conquer as in Cilk: Blumofe et al., "Cilk: an efficient multithreaded runtime system", PPoPP 1995; in
//! Rust, `join` of rayon. A worker continues with the first half and leaves the second where others may steal it. A
//! comparison with `rayon` shows the overhead of parallel iterators on the same halving.
//!
//! Cost: threads start once, in the construction and not in the run. One `join` for each job, which is a push and a pop on the worker's
//! own deque unless the second half was stolen.

use std::ops::Range;

use ::rayon::join;

use super::rayon_pool::in_pool;
use crate::{Discipline, Entry};

pub(super) const ENTRY: Entry =
    Entry::new("rayon-join", "rayon's join, halving the jobs down to single ones", Discipline::Halving, |blueprint| {
        in_pool(blueprint, |panics, jobs, job| halve(0..jobs, &|index| panics.attempt(|| job(index))))
    });

/// Runs the jobs of a range, whose two halves may run on two workers.
fn halve(range: Range<usize>, leaf: &(impl Fn(usize) + Sync)) {
    let Range { start, end } = range;
    match end - start {
        0 => {}
        1 => leaf(start),
        jobs => {
            let middle = start + jobs / 2;
            join(|| halve(start..middle, leaf), || halve(middle..end, leaf));
        }
    }
}
