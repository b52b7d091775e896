//! Chili: the range of jobs is halved by `join`, and work is shared only at a heartbeat.
//!
//! `pathmark render cornell --strategy chili --threads 4`
//!
//! Acar, Charguéraud, Guatto, Rainey and Sieczkowski, "Heartbeat scheduling: provable efficiency for nested parallelism", PLDI 2018, as the
//! crate `chili` has it. A `join` costs a few nanoseconds, because its second half stays private to the worker. Every 100 microseconds a
//! clock's thread sets each worker's flag; a worker that sees its flag hands over the largest half that it still has.
//!
//! Cost: threads start once, in the construction and not in the run. Two cheap `join`s for each job and a box for each half handed over. The
//! flag is seen between jobs only, so while a worker is in a long one, what it keeps waits with it.

use std::ops::Range;
use std::sync::Arc;

use ::chili::{Config as PoolConfig, Scope, ThreadPool};

use crate::host::Host;
use crate::{Blueprint, Discipline, Entry, Job, Sharing, Strategy, StrategyError, Threads, library};

pub(super) const ENTRY: Entry = Entry {
    threads: Threads::Library,
    sharing: Sharing::Heartbeat,
    ..Entry::new(
        "chili",
        "halving by join in a pool that shares work at heartbeats (the crate chili)",
        Discipline::Halving,
        make,
    )
};

fn make(blueprint: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    let threads = blueprint.threads;
    // Chili counts the thread that uses the pool, here the host, and starts one fewer. Its clock's thread comes on top.
    let config = PoolConfig { thread_count: Some(threads), ..PoolConfig::default() };
    let pool = library::start(blueprint, threads.get() + 1, || ThreadPool::with_config(config))?;
    Ok(Box::new(Chili { host: Host::new(blueprint)?, pool: Arc::new(pool) }))
}

struct Chili {
    host: Host,
    pool: Arc<ThreadPool>,
}

impl Strategy for Chili {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let pool = Arc::clone(&self.pool);
        self.host.run(move |panics| halve(&mut pool.scope(), 0..jobs, &|index| panics.attempt(|| job(index))));
        Ok(())
    }
}

/// Runs the jobs of a range. Chili runs the second closure of a `join` first, and looks at the flag when it comes to the first one; the
/// `1` says that it does so each time.
fn halve(scope: &mut Scope<'_>, range: Range<usize>, leaf: &(impl Fn(usize) + Sync)) {
    let Range { start, end } = range;
    match end - start {
        0 => {}
        // A `join` with nothing, so that the flag is looked at before the very first job too.
        1 => drop(scope.join_with_heartbeat_every::<1, _, _, _, _>(|_| leaf(start), |_| ())),
        jobs => {
            let middle = start + jobs / 2;
            scope.join_with_heartbeat_every::<1, _, _, _, _>(
                |scope| halve(scope, middle..end, leaf),
                |scope| halve(scope, start..middle, leaf),
            );
        }
    }
}
