//! Panics: a panic in a job reaches the caller as it was thrown, and leaves no clone of the job and no thread behind.

use std::any::Any;
use std::mem;
use std::panic::{self, AssertUnwindSafe};
use std::sync::{Arc, Mutex, PoisonError};

use super::case::Case;
use super::meeting::Meeting;
use super::spawner::CountedThreads;
use crate::library::message;
use crate::{Job, Strategy, Workers};

/// Runs jobs of which one must panic, and returns the payload that reaches the caller.
pub(super) fn thrown(strategy: &mut dyn Strategy, jobs: usize, job: Job) -> Result<Box<dyn Any + Send>, String> {
    match panic::catch_unwind(AssertUnwindSafe(|| strategy.run(jobs, job))) {
        Err(payload) => Ok(payload),
        Ok(Ok(())) => Err("no panic reaches the caller".to_owned()),
        Ok(Err(error)) => Err(format!("an error reaches the caller instead of the panic: {error}")),
    }
}

/// Panics without the report on stderr that `panic!` would make for each of some thousand panics.
fn throw(index: usize) {
    panic::resume_unwind(Box::new(format!("job {index} fails")));
}

/// A value that panics when a job drops it.
struct Bomb(usize);

impl Drop for Bomb {
    fn drop(&mut self) {
        throw(self.0);
    }
}

/// A way to panic in job `index`; all jobs share the lock.
type Way = fn(usize, &Mutex<usize>);

/// The places in a job where a panic may start.
const WAYS: [(&str, Way); 3] = [
    ("in its body", |index, _| throw(index)),
    ("in a drop", |index, _| drop(Bomb(index))),
    ("while it holds a lock", |index, shared| {
        let _held = shared.lock().unwrap_or_else(PoisonError::into_inner);
        throw(index);
    }),
];

pub(super) fn in_any_job(case: &Case) -> Result<(), String> {
    // With a thread for each job, thousands of runs of a thousand jobs would take minutes.
    let (jobs, step) = match (case.entry.workers, case.contract.thorough) {
        (Workers::PerJob, false) => (100, 33),
        (_, false) => (1000, 111),
        (_, true) => (1000, 1),
    };
    for threads in case.threads() {
        let spawner = CountedThreads::unlimited();
        let mut strategy = case.build(threads, &spawner)?;
        for culprit in (0..jobs).step_by(step) {
            let (way, throws) = WAYS[culprit % WAYS.len()];
            case.at(format!("{threads} threads, {jobs} jobs, job {culprit} panics {way}"));
            let runs = case.runs(jobs);
            let (noted, shared) = (runs.clone(), Mutex::new(0));
            let job: Job = Arc::new(move |index| {
                noted.note(index);
                if index == culprit {
                    throws(index, &shared);
                }
                *shared.lock().unwrap_or_else(PoisonError::into_inner) += 1;
            });
            let payload = thrown(&mut *strategy, jobs, Arc::clone(&job))?;
            let (expected, found) = (format!("job {culprit} fails"), message(&*payload));
            if found != expected {
                return Err(format!("the job threw {expected:?}, but {found:?} reaches the caller"));
            }
            runs.none_twice()?;
            if let left @ 1.. = Arc::strong_count(&job) - 1 {
                return Err(format!("{left} clones of the job are left"));
            }
            case.run_each_once(&mut *strategy, 20).map_err(|found| format!("in the next run {found}"))?;
        }
        drop(strategy);
        spawner.none_left()?;
    }
    Ok(())
}

/// A payload that panics when it is dropped. A pool's worker that dropped it would be missing in the next run.
struct Spiteful;

impl Drop for Spiteful {
    fn drop(&mut self) {
        panic::resume_unwind(Box::new("dropped"));
    }
}

pub(super) fn of_all_workers(case: &Case) -> Result<(), String> {
    let threads = case.up_to(3);
    let mut strategy = case.ready(threads)?;
    for round in 0..20 {
        for (jobs, meeting) in Meeting::plans(case, threads)? {
            case.at(format!("{threads} threads, {jobs} jobs that panic together, round {round}"));
            let job = move |index| {
                meeting.wait(index);
                if meeting.invites(index) {
                    panic::resume_unwind(Box::new(Spiteful));
                }
            };
            let payload = thrown(&mut *strategy, jobs, Arc::new(job))?;
            let arrived = payload.is::<Spiteful>();
            // Dropped while unwinding, it would end the whole program.
            mem::forget(payload);
            if !arrived {
                return Err("a different payload reaches the caller".to_owned());
            }
            case.run_each_once(&mut *strategy, 30).map_err(|found| format!("in the next run {found}"))?;
        }
    }
    Ok(())
}
