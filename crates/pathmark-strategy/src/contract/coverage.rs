//! Coverage: each job runs exactly once, for any numbers of jobs and threads, and in every run of a strategy.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use super::case::{Case, run};
use crate::Job;

/// Tests no jobs, fewer jobs than threads, as many, more, and many.
pub(super) fn any_numbers(case: &Case) -> Result<(), String> {
    for threads in case.threads() {
        for jobs in [0, 1, threads - 1, threads, threads + 1, 1000] {
            case.at(format!("{threads} threads, {jobs} jobs"));
            case.run_each_once(&mut *case.ready(threads)?, jobs)?;
        }
    }
    Ok(())
}

pub(super) fn many_runs(case: &Case) -> Result<(), String> {
    let threads = case.up_to(3);
    let mut strategy = case.ready(threads)?;
    for (run, jobs) in [100, 0, 2, 7, 100, 1000, 1, 3].into_iter().cycle().take(40).enumerate() {
        case.at(format!("{threads} threads, {jobs} jobs, run {} of one object", run + 1));
        case.run_each_once(&mut *strategy, jobs)?;
    }
    Ok(())
}

/// Tests more jobs than fit into a bounded channel, a block of an unbounded channel, or the first buffer of a deque.
pub(super) fn many_jobs(case: &Case) -> Result<(), String> {
    const JOBS: usize = 20_000;
    let threads = case.up_to(2);
    // No system provides a thread for each of so many jobs.
    if case.entry.workers.at_once(threads, JOBS) < JOBS {
        case.at(format!("{threads} threads, {JOBS} jobs"));
        case.run_each_once(&mut *case.ready(threads)?, JOBS)?;
    }
    Ok(())
}

/// Delays one job, which ends early if the run returns before it.
pub(super) fn ends_last(case: &Case) -> Result<(), String> {
    const JOBS: usize = 8;
    const SLOW: Duration = Duration::from_millis(50);
    for threads in case.threads() {
        for slow in [0, JOBS - 1] {
            case.at(format!("{threads} threads, {JOBS} jobs, of which job {slow} takes {SLOW:?}"));
            let runs = case.runs(JOBS);
            let ended = Arc::new(AtomicUsize::new(0));
            let returned = Arc::new((Mutex::new(false), Condvar::new()));
            let (noted, counted, waited) = (runs.clone(), Arc::clone(&ended), Arc::clone(&returned));
            let job = move |index| {
                if index == slow {
                    let (returned, change) = &*waited;
                    let returned = returned.lock().unwrap_or_else(PoisonError::into_inner);
                    drop(change.wait_timeout_while(returned, SLOW, |returned| !*returned));
                }
                noted.note(index);
                counted.fetch_add(1, Ordering::SeqCst);
            };
            run(&mut *case.ready(threads)?, JOBS, Arc::new(job))?;
            let ended = ended.load(Ordering::SeqCst);
            *returned.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
            returned.1.notify_all();
            if ended < JOBS {
                return Err(format!("{} jobs had not ended when the run returned", JOBS - ended));
            }
            runs.each_once()?;
        }
    }
    Ok(())
}

pub(super) fn no_job_left(case: &Case) -> Result<(), String> {
    for threads in case.threads() {
        let mut strategy = case.ready(threads)?;
        for jobs in [0, 1, 50] {
            case.at(format!("{threads} threads, {jobs} jobs"));
            let job: Job = Arc::new(|_| ());
            run(&mut *strategy, jobs, Arc::clone(&job))?;
            if let left @ 1.. = Arc::strong_count(&job) - 1 {
                return Err(format!("{left} clones are left when the run has ended"));
            }
        }
    }
    Ok(())
}
