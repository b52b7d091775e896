//! Threads: all come from the spawner, none is started without use, and all end; a refused thread is an error.

use std::sync::Arc;

use super::case::Case;
use super::spawner::CountedThreads;
use crate::{Job, StrategyError, Threads, Workers};

/// A pool starts its threads once, other strategies in each run: never more than requested, and in a run at most one
/// for each job.
pub(super) fn none_in_vain(case: &Case) -> Result<(), String> {
    const JOBS: usize = 3;
    let threads = case.up_to(8);
    if case.entry.threads == Threads::Library {
        return Ok(());
    }
    let spawner = CountedThreads::unlimited();
    let mut strategy = case.build(threads, &spawner)?;
    let workers = if case.entry.workers == Workers::Caller { 0 } else { case.entry.workers.at_once(threads, JOBS) };
    let (mut before, mut started) = (0, Vec::new());
    for run in 0..=2 {
        case.at(format!("{threads} threads, run {run} of {JOBS} jobs each"));
        if run > 0 {
            case.run_each_once(&mut *strategy, JOBS)?;
        }
        started.push(spawner.asked() - before);
        before = spawner.asked();
    }
    // Threads started in the construction, in the first run (a pool may wait for that) and in the second.
    let right = match started[..] {
        [pool, 0, 0] | [0, pool, 0] if pool <= threads && pool >= workers => true,
        [0, first, second] => first == workers && second == workers,
        _ => false,
    };
    if right {
        return Ok(());
    }
    Err(format!(
        "the construction started {} threads and the runs {:?}, but {workers} are needed",
        started[0],
        &started[1..]
    ))
}

pub(super) fn none_left(case: &Case) -> Result<(), String> {
    for threads in case.threads() {
        for runs in 0..=2 {
            case.at(format!("{threads} threads, {runs} runs"));
            let spawner = CountedThreads::unlimited();
            let mut strategy = case.build(threads, &spawner)?;
            for _ in 0..runs {
                case.run_each_once(&mut *strategy, 10)?;
            }
            drop(strategy);
            spawner.none_left()?;
        }
    }
    Ok(())
}

/// Refuses each thread in turn, once or together with all that follow.
pub(super) fn refused(case: &Case) -> Result<(), String> {
    let threads = case.up_to(8);
    for jobs in [threads, 100] {
        for first in 0..case.entry.workers.at_once(threads, jobs) {
            for (often, until) in [("once", first + 1), ("and all that follow", usize::MAX)] {
                case.at(format!("{threads} threads, {jobs} jobs, thread {} is refused {often}", first + 1));
                let spawner = CountedThreads::refusing(first..until);
                let runs = case.runs(jobs);
                let job = runs.job();
                let mut made = case.try_build(threads, &spawner);
                let outcome = match &mut made {
                    Ok(strategy) => strategy.run(jobs, Arc::clone(&job)),
                    Err(_) => Ok(()),
                };
                was_told(&spawner, made.as_ref().err().or(outcome.as_ref().err()))?;
                runs.none_twice()?;
                no_clone(&job)?;
                if let Ok(strategy) = &mut made {
                    if outcome.is_ok() {
                        runs.each_once()?;
                    } else if until == first + 1 {
                        case.run_each_once(&mut **strategy, jobs)
                            .map_err(|found| format!("in the next run {found}"))?;
                    }
                }
                drop(made);
                spawner.none_left()?;
            }
        }
    }
    Ok(())
}

fn was_told(spawner: &CountedThreads, error: Option<&StrategyError>) -> Result<(), String> {
    match error {
        None if spawner.refusals() > 0 => Err("no error is returned".to_owned()),
        None => Ok(()),
        Some(StrategyError::Spawn { worker, workers, .. }) if (1..=*workers).contains(worker) => Ok(()),
        Some(other) => Err(format!("a different error is returned: {other}")),
    }
}

fn no_clone(job: &Job) -> Result<(), String> {
    match Arc::strong_count(job) - 1 {
        0 => Ok(()),
        left => Err(format!("{left} clones of the job are left")),
    }
}
