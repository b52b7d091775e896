//! `forkunion`: a C++ pool whose workers wait for the next run without system calls.
//!
//! `pathmark render cornell --strategy forkunion --threads 4`, in a build with `--features more-pools`, which needs a C++ compiler.
//!
//! The crate `forkunion`, over the C++ library of that name, with its `for_n_dynamic`: a free worker takes the next
//! job. A run takes no lock and makes no system call.
//!
//! Cost: threads start once, in the construction and not in the run. Between runs, and when they find no job, the
//! workers spin, and each occupies a processor. A job costs an atomic addition and a call through C.

use forkunion::{CallerExclusivity, ThreadPool, Topology};

use crate::{Blueprint, Discipline, Entry, Job, Panics, Strategy, StrategyError, Threads, library};

pub(super) const ENTRY: Entry = Entry {
    threads: Threads::Library,
    ..Entry::new(
        "forkunion",
        "a free worker takes the next index, in a pool that never sleeps (the crate forkunion)",
        Discipline::ONE_BY_ONE,
        make,
    )
};

fn make(blueprint: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    let threads = blueprint.threads.get();
    let refused = |error: forkunion::Error| StrategyError::Spawn {
        worker: threads,
        workers: threads,
        source: std::io::Error::other(format!("{error:?}")),
    };
    let spawn = || {
        let topology = Topology::new()?;
        // The caller of a run only waits.
        ThreadPool::try_spawn_with_exclusivity(&topology, threads, CallerExclusivity::Exclusive)
    };
    Ok(Box::new(ForkUnion(library::start(blueprint, threads, spawn)?.map_err(refused)?)))
}

struct ForkUnion(ThreadPool);

impl Strategy for ForkUnion {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let panics = Panics::default();
        // Dropping the returned value runs the loop.
        drop(self.0.for_n_dynamic(jobs, |prong| panics.attempt(|| job(prong.task_index))));
        drop(job);
        panics.raise();
        Ok(())
    }
}
