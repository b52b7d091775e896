//! Rayon: a parallel iterator over the jobs, split down to single jobs.
//!
//! `pathmark render cornell --strategy rayon --threads 4`
//!
//! Most Rust programs use this library, and in this form. The range of jobs is halved again and again by `join`, whose
//! second half may be stolen (the scheme of Cilk: Blumofe and Leiserson, JACM 46(5), 1999).
//!
//! Cost: threads start once, in the construction and not in the run. A run wakes the pool; a job is a leaf of the tree of joins
//! and costs about one push and pop on the worker's own deque. Idle workers search for a while before they sleep.

use ::rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

use super::rayon_pool::in_pool;
use crate::{Discipline, Entry, Job, Panics};

pub(super) const ENTRY: Entry = Entry::new(
    "rayon",
    "rayon's parallel iterator in its own pool, split down to single jobs",
    Discipline::Halving,
    |blueprint| in_pool(blueprint, run),
);

fn run(panics: &Panics, jobs: usize, job: &Job) {
    let leaf = |index| panics.attempt(|| job(index));
    (0..jobs).into_par_iter().with_max_len(1).for_each(leaf);
}
