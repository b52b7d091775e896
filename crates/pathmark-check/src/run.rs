//! Runs many cases in parallel.

use super::{Case, Effort, Outcome};
use crate::error::{Error, Result};
use std::panic::resume_unwind;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::thread;

/// Runs the cases on so many threads. Calls `told` with the number of finished cases. The outcomes are in the order of
/// the cases.
pub fn run(
    cases: &[&'static Case],
    effort: Effort,
    threads: usize,
    told: &(dyn Fn(u64) + Sync),
) -> Result<Vec<Outcome>> {
    let (next, done) = (AtomicUsize::new(0), AtomicU64::new(0));
    let parts = on_threads(threads.max(1), || {
        let mut outcomes: Vec<(usize, Outcome)> = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(case) = cases.get(index) else { return outcomes };
            outcomes.push((index, case.run(effort)));
            told(done.fetch_add(1, Ordering::Relaxed) + 1);
        }
    })?;
    let mut outcomes = parts.concat();
    outcomes.sort_by_key(|(index, _)| *index);
    Ok(outcomes.into_iter().map(|(_, outcome)| outcome).collect())
}

/// Returns the result of `body` on each of `count` threads. Runs it on none of them unless the system starts all.
pub(super) fn on_threads<T: Send>(count: usize, body: impl Fn() -> T + Sync) -> Result<Vec<T>> {
    let all_are_there: OnceLock<bool> = OnceLock::new();
    let work = || all_are_there.wait().then(&body);
    thread::scope(|scope| {
        let start = |number| {
            let refused = |e| Error::system("starting", format!("thread {number} of {count}"), e);
            thread::Builder::new().spawn_scoped(scope, work).map_err(refused)
        };
        let started: Result<Vec<_>> = (1..=count).map(start).collect();
        all_are_there.get_or_init(|| started.is_ok());
        let ended = started?.into_iter().map(|handle| handle.join().unwrap_or_else(|panic| resume_unwind(panic)));
        Ok(ended.flatten().collect())
    })
}
