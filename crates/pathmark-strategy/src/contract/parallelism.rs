//! Parallelism: as many jobs run at a time as there are workers, no fewer and no more.

use std::collections::HashSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};

use super::case::{Case, run};
use super::meeting::Meeting;
use crate::{Sharing, Workers};

/// Combines the results of meetings. With heartbeats jobs need not meet, so one success among easier and easier
/// meetings is enough. Otherwise all meetings must succeed.
fn verdict(sharing: Sharing, meetings: impl Iterator<Item = Result<(), String>>) -> Result<(), String> {
    match sharing {
        Sharing::AtOnce => meetings.collect(),
        Sharing::Heartbeat => {
            let mut last = Ok(());
            for meeting in meetings {
                if meeting.is_ok() {
                    return meeting;
                }
                last = meeting;
            }
            last
        }
    }
}

/// Tests many rounds: a worker that leaves too early does so in a gap of nanoseconds, and a surplus worker may come too
/// late to meet others.
pub(super) fn as_many_as_told(case: &Case) -> Result<(), String> {
    for threads in case.threads() {
        let mut strategy = case.ready(threads)?;
        for round in 0..30 {
            let mut excess = Ok(());
            let meetings = Meeting::plans(case, threads)?.into_iter().map(|(jobs, meeting)| {
                case.at(format!("{threads} threads, {jobs} jobs that wait for each other, round {round}"));
                let seen = Arc::new(Seen::default());
                let meeting = Arc::new(meeting);
                let runs = case.runs(jobs);
                let (noted, place, who) = (runs.clone(), Arc::clone(&meeting), Arc::clone(&seen));
                let job = move |index| {
                    noted.note(index);
                    who.during(|| place.wait(index));
                };
                run(&mut *strategy, jobs, Arc::new(job))?;
                runs.each_once()?;
                if excess.is_ok() {
                    excess = seen.no_more_than(case.entry.workers.at_once(threads, jobs));
                }
                meeting.met()?;
                seen.are(case.entry.workers, threads, jobs)
            });
            let verdict = verdict(case.entry.sharing, meetings);
            excess.and(verdict)?;
        }
    }
    Ok(())
}

/// The threads that jobs run on, and how many jobs run at a time.
#[derive(Default)]
struct Seen {
    threads: Mutex<HashSet<ThreadId>>,
    running: AtomicUsize,
    most: AtomicUsize,
}

impl Seen {
    fn during(&self, job: impl FnOnce()) {
        self.threads().insert(thread::current().id());
        self.most.fetch_max(self.running.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
        job();
        self.running.fetch_sub(1, Ordering::SeqCst);
    }

    fn threads(&self) -> MutexGuard<'_, HashSet<ThreadId>> {
        self.threads.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn no_more_than(&self, expected: usize) -> Result<(), String> {
        let most = self.most.load(Ordering::SeqCst);
        if most > expected {
            return Err(format!("{most} jobs at a time instead of {expected}"));
        }
        let threads = self.threads().len();
        if threads > expected {
            return Err(format!("jobs ran on {threads} threads instead of {expected}"));
        }
        Ok(())
    }

    /// Checks that jobs ran on as many threads as `workers` says, and on the caller's thread only if it says so.
    fn are(&self, workers: Workers, threads: usize, jobs: usize) -> Result<(), String> {
        let (seen, expected) = (self.threads(), workers.at_once(threads, jobs));
        if seen.len() != expected {
            return Err(format!("jobs ran on {} threads instead of {expected}", seen.len()));
        }
        let (on_caller, said) = (seen.contains(&thread::current().id()), workers == Workers::Caller);
        if on_caller != said {
            let not = if on_caller { "" } else { "not " };
            return Err(format!("jobs ran {not}on the caller's thread, but its workers are {workers:?}"));
        }
        Ok(())
    }
}
