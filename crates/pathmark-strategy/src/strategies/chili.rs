//! Chili: the range of jobs is halved by `join`, and work is shared only at a heartbeat.
//!
//! `pathmark render cornell --strategy chili --threads 4`
//!
//! Acar, Charguéraud, Guatto, Rainey and Sieczkowski, "Heartbeat scheduling: provable efficiency for nested
//! parallelism", PLDI 2018, as implemented by the crate `chili`. A `join` costs a few nanoseconds, because its second
//! half stays private to the worker. Every 100 microseconds a clock thread sets each worker's flag. A worker that sees
//! its flag hands over the largest half that it still has.
//!
//! Cost: threads start once, in the construction and not in the run. Each job costs two cheap `join`s, and each half
//! handed over costs a box. A worker checks its flag only between jobs, so during a long job its other jobs wait with
//! it.

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
    // Chili counts the thread that uses the pool, here the host, and starts one thread fewer. It also starts a clock
    // thread.
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

/// Runs the jobs of a range. Chili runs the second closure of a `join` first, and checks the flag before the first one;
/// the `1` makes it check each time.
fn halve(scope: &mut Scope<'_>, range: Range<usize>, leaf: &(impl Fn(usize) + Sync)) {
    let Range { start, end } = range;
    match end - start {
        0 => {}
        // A `join` with an empty closure, so that the flag is checked before the very first job, too.
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
