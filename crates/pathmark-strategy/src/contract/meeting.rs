//! Meetings: jobs that wait for each other show how many can run at the same time.

use std::collections::BTreeSet;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::case::Case;
use crate::{Discipline, Sharing};

/// How long a job waits for others in the first plan for heartbeats, where the others need not come.
const SHORT: Duration = Duration::from_millis(2);

/// A reusable barrier: jobs wait until `size` of them are present.
pub(super) struct Meeting {
    size: usize,
    /// The jobs that wait; all jobs if `None`.
    invited: Option<BTreeSet<usize>>,
    /// No job waits after the first meeting.
    once: bool,
    sharing: Sharing,
    patience: Duration,
    state: Mutex<State>,
    change: Condvar,
}

#[derive(Default)]
struct State {
    present: usize,
    most: usize,
    /// Counts meetings, so that jobs that wait for one meeting don't wait for the next.
    met: usize,
    given_up: bool,
}

impl Meeting {
    /// Returns a meeting of `size` jobs. Only the invited jobs wait, and at most for `patience`.
    fn new(case: &Case, size: usize, invited: Option<BTreeSet<usize>>, patience: Duration) -> Self {
        let sharing = case.entry.sharing;
        let once = sharing == Sharing::Heartbeat;
        Self { size, invited, once, sharing, patience, state: Mutex::default(), change: Condvar::new() }
    }

    /// Returns pairs of a number of jobs to run and their meeting. The strategy with `threads` threads must have a
    /// worker for each job of a meeting.
    pub(super) fn plans(case: &Case, threads: usize) -> Result<Vec<(usize, Self)>, String> {
        let discipline =
            case.entry.discipline(case.contract.parameter.as_deref()).map_err(|error| error.to_string())?;
        let patience = case.contract.patience;
        if case.entry.sharing == Sharing::Heartbeat {
            // Many jobs, so that there is work to share at one heartbeat after the other; fewer if each may take long.
            let plan = |(jobs, factor): (usize, u32)| (jobs * threads, Self::new(case, threads, None, SHORT * factor));
            return Ok([(200, 1), (50, 10), (12, 100)].map(plan).into());
        }
        let all = |jobs: usize| (jobs, Self::new(case, case.entry.workers.at_once(threads, jobs), None, patience));
        let some =
            |jobs: usize, invited: BTreeSet<usize>| (jobs, Self::new(case, invited.len(), Some(invited), patience));
        Ok(match discipline {
            // A worker's second job starts after the first has ended, which could be waiting for the second. So only
            // first jobs meet.
            Discipline::Dealt(deal) => [threads, 5 * threads]
                .map(|jobs| some(jobs, (0..threads).filter_map(|worker| deal(worker, threads, jobs).next()).collect()))
                .into(),
            Discipline::Chunks(rule) if rule.chunks(5 * threads, threads).any(|chunk| chunk.len() > 1) => {
                let heads =
                    |jobs| rule.chunks(jobs, threads).map(|chunk| chunk.start).take(threads).collect::<BTreeSet<_>>();
                let enough = [1, 5, 50, 500, 5000].map(|each| each * threads);
                let mut plans =
                    enough.into_iter().map(|jobs| (jobs, heads(jobs))).filter(|(_, heads)| heads.len() == threads);
                plans.next().map(|(jobs, heads)| some(jobs, heads)).into_iter().collect()
            }
            // Later chunks depend on the clock, but every worker begins with one job.
            Discipline::Learned(_) => {
                [threads, 5 * threads].map(|jobs| (jobs, Self { once: true, ..all(jobs).1 })).into()
            }
            // With more jobs than workers, a worker that has taken several and waits in the first must leave the rest
            // to others.
            _ => vec![all(threads), all(5 * threads)],
        })
    }

    /// Returns a meeting of the first `size` jobs to begin.
    pub(super) fn of_first(case: &Case, size: usize) -> Self {
        Self::new(case, size, None, case.contract.patience)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns whether job `index` waits in this meeting.
    pub(super) fn invites(&self, index: usize) -> bool {
        self.invited.as_ref().is_none_or(|invited| invited.contains(&index))
    }

    /// Makes job `index` wait for the others. It does not wait after a meeting has failed, or after a success if one is
    /// enough.
    pub(super) fn wait(&self, index: usize) {
        if !self.invites(index) {
            return;
        }
        let mut state = self.state();
        let met = state.met;
        if state.given_up || (self.once && met > 0) {
            return;
        }
        state.present += 1;
        state.most = state.most.max(state.present);
        if state.present == self.size {
            (state.present, state.met) = (0, met + 1);
            self.change.notify_all();
            return;
        }
        let waiting = |state: &mut State| state.met == met && !state.given_up;
        let (mut state, waited) =
            self.change.wait_timeout_while(state, self.patience, waiting).unwrap_or_else(PoisonError::into_inner);
        if waited.timed_out() && state.met == met {
            state.present -= 1;
            state.given_up = self.sharing == Sharing::AtOnce;
            self.change.notify_all();
        }
    }

    /// Checks, after a run, that the jobs have met, and that no meeting has failed where all are required.
    pub(super) fn met(&self) -> Result<(), String> {
        let state = self.state();
        if state.met > 0 && !state.given_up {
            return Ok(());
        }
        Err(format!(
            "{} jobs at a time instead of {}, though each waited {:?} for more",
            state.most, self.size, self.patience
        ))
    }
}
