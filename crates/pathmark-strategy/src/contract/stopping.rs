//! Stopping: after a panic, only workers that have not noticed it yet begin a further job.

use std::panic;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use super::case::Case;
use super::panics::thrown;
use crate::Workers;

/// A single worker must stop at once.
pub(super) fn alone(case: &Case) -> Result<(), String> {
    const JOBS: usize = 10_000;
    const LAST: usize = 10;
    if case.entry.workers == Workers::PerJob {
        return Ok(());
    }
    case.at(format!("1 thread, {JOBS} jobs, the {LAST}th panics"));
    let runs = case.runs(JOBS);
    let (noted, begun) = (runs.clone(), AtomicUsize::new(0));
    let job = move |index| {
        noted.note(index);
        if begun.fetch_add(1, Ordering::SeqCst) + 1 == LAST {
            panic::resume_unwind(Box::new(()));
        }
    };
    thrown(&mut *case.ready(1)?, JOBS, Arc::new(job))?;
    match runs.started() {
        LAST => Ok(()),
        started => Err(format!("{} jobs began after the panic", started - LAST)),
    }
}

/// The second job to begin panics, and all jobs take a millisecond. The two workers must stop in the first half of the
/// jobs, whose number follows from the patience.
pub(super) fn others(case: &Case) -> Result<(), String> {
    const EACH: Duration = Duration::from_millis(1);
    let threads = case.up_to(2);
    if case.entry.workers != Workers::Threads || threads < 2 {
        return Ok(());
    }
    let jobs = ((case.contract.patience.as_millis() / 8) as usize).clamp(50, 4000);
    case.at(format!("2 threads, {jobs} jobs of {EACH:?}, the second to begin panics"));
    let runs = case.runs(jobs);
    let (noted, begun) = (runs.clone(), AtomicUsize::new(0));
    let job = move |index| {
        noted.note(index);
        if begun.fetch_add(1, Ordering::SeqCst) == 1 {
            panic::resume_unwind(Box::new(()));
        }
        thread::sleep(EACH);
    };
    thrown(&mut *case.ready(2)?, jobs, Arc::new(job))?;
    let started = runs.started();
    if started >= jobs / 2 {
        let allowed = EACH * (jobs / 2) as u32;
        return Err(format!("{started} jobs began, so the workers did not notice the panic for {allowed:?}"));
    }
    Ok(())
}
