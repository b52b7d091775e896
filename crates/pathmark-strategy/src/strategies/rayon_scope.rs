//! Rayon's scope: every job is spawned as its own task.
//!
//! `pathmark render cornell --strategy rayon-scope --threads 4`
//!
//! The method of programs that find their work step by step, such as a server or a tree traversal; the tasks of Cilk
//! without its recursion (Blumofe et al., "Cilk: an efficient multithreaded runtime system", PPoPP 1995). One worker
//! pushes all tasks onto its own deque, and only then begins with the last. Meanwhile the others steal from the front,
//! one task at a time.
//!
//! Cost: threads start once, in the construction and not in the run. Each job costs an allocation, a push by the one
//! worker, and a theft if another worker runs it. With small jobs the worker that spawns is the bottleneck.

use ::rayon::scope;

use super::rayon_pool::in_pool;
use crate::{Discipline, Entry, Job, Panics};

pub(super) const ENTRY: Entry =
    Entry::new("rayon-scope", "rayon's scope, one task for each job", Discipline::ONE_BY_ONE, |blueprint| {
        in_pool(blueprint, run)
    });

fn run(panics: &Panics, jobs: usize, job: &Job) {
    // Tasks borrow the job: a clone for each would cost two atomic updates on a cache line that all workers use.
    let job = &**job;
    scope(|scope| {
        for index in 0..jobs {
            scope.spawn(move |_| panics.attempt(|| job(index)));
        }
    });
}
