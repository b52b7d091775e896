//! Rayon's scope: every job is spawned as a task of its own.
//!
//! `pathmark render cornell --strategy rayon-scope --threads 4`
//!
//! What a program does that meets its work piece by piece, such as a server or a walk through a tree; the tasks of Cilk without its
//! recursion (Blumofe et al., "Cilk: an efficient multithreaded runtime system", PPoPP 1995). One worker puts all tasks into its own deque,
//! and only then begins with the last; the others have stolen them from the front meanwhile, one at a time.
//!
//! Cost: threads start once, in the construction and not in the run. Each job is an allocation, a push by the one worker, and a theft for
//! every job that another worker runs. With small jobs the worker that spawns is the bottleneck.

use ::rayon::scope;

use super::rayon_pool::Pool;
use crate::{Blueprint, Discipline, Entry, Job, Strategy, StrategyError};

pub(super) const ENTRY: Entry =
    Entry::new("rayon-scope", "rayon's scope, one task for each job", Discipline::ONE_BY_ONE, make);

fn make(blueprint: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    Ok(Box::new(RayonScope(Pool::new(blueprint)?)))
}

struct RayonScope(Pool);

impl Strategy for RayonScope {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        self.0.run(|panics| {
            // Tasks borrow the job: a clone for each would be two atomic updates on a line that all workers want.
            let job = &*job;
            scope(|scope| {
                for index in 0..jobs {
                    scope.spawn(move |_| panics.attempt(|| job(index)));
                }
            });
        });
        Ok(())
    }
}
