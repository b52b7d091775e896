//! As many jobs at a time as there are workers: no fewer, and no more.

use std::collections::HashSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use super::case::{Case, run};
use super::meeting::Meeting;
use crate::{Sharing, Workers};

/// Where jobs need not come together, one meeting out of some that get easier is enough. Else all must come about.
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

/// Many rounds, because a worker that leaves too early does so in a gap of nanoseconds.
pub(super) fn all_meet(case: &Case) -> Result<(), String> {
    for threads in case.threads() {
        let mut strategy = case.ready(threads)?;
        for round in 0..30 {
            let meetings = Meeting::plans(case, threads)?.into_iter().map(|(jobs, meeting)| {
                case.at(format!("{threads} threads, {jobs} jobs that wait for each other, round {round}"));
                let meeting = Arc::new(meeting);
                let (place, runs) = (Arc::clone(&meeting), case.runs(jobs));
                let noted = runs.clone();
                let job = move |index| {
                    noted.note(index);
                    place.wait(index);
                };
                run(&mut *strategy, jobs, Arc::new(job))?;
                runs.each_once()?;
                meeting.met()
            });
            verdict(case.entry.sharing, meetings)?;
        }
    }
    Ok(())
}

/// The threads that jobs run on, and how many jobs run at a time.
pub(super) fn no_more_than_asked(case: &Case) -> Result<(), String> {
    for threads in case.threads() {
        let meetings = Meeting::plans(case, threads)?.into_iter().map(|(jobs, meeting)| {
            case.at(format!("{threads} threads, {jobs} jobs that wait for each other"));
            let expected = case.entry.workers.at_once(threads, jobs);
            let meeting = Arc::new(meeting);
            let seen = Arc::new(Mutex::new(HashSet::new()));
            let (running, most) = (AtomicUsize::new(0), Arc::new(AtomicUsize::new(0)));
            let (place, ids, peak) = (Arc::clone(&meeting), Arc::clone(&seen), Arc::clone(&most));
            let job = move |index| {
                ids.lock().unwrap_or_else(PoisonError::into_inner).insert(thread::current().id());
                peak.fetch_max(running.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                place.wait(index);
                running.fetch_sub(1, Ordering::SeqCst);
            };
            run(&mut *case.ready(threads)?, jobs, Arc::new(job))?;
            meeting.met()?;
            let most = most.load(Ordering::SeqCst);
            if most > expected {
                return Err(format!("{most} jobs at a time instead of {expected}"));
            }
            let seen = seen.lock().unwrap_or_else(PoisonError::into_inner);
            if seen.len() != expected {
                return Err(format!("jobs ran on {} threads instead of {expected}", seen.len()));
            }
            let (on_caller, said) = (seen.contains(&thread::current().id()), case.entry.workers == Workers::Caller);
            if on_caller != said {
                let not = if on_caller { "" } else { "not " };
                return Err(format!(
                    "jobs ran {not}on the caller's thread, but its workers are {:?}",
                    case.entry.workers
                ));
            }
            Ok(())
        });
        verdict(case.entry.sharing, meetings)?;
    }
    Ok(())
}
