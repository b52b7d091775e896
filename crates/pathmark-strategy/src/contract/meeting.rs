//! Jobs that wait for each other, which shows how many can run at the same time.

use std::collections::BTreeSet;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::case::Case;
use crate::{Discipline, Sharing};

/// How long a job waits for others where they need not come, the first time that they are asked for.
const SHORT: Duration = Duration::from_millis(2);

/// A place where jobs wait until so many of them are there, again and again.
pub(super) struct Meeting {
    size: usize,
    /// Those who wait; all if `None`.
    invited: Option<BTreeSet<usize>>,
    /// Nobody waits after the first meeting.
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
    /// Counts meetings, so that those who wait for one don't wait for the next.
    met: usize,
    given_up: bool,
}

impl Meeting {
    /// Where `size` jobs come together, if only those that are invited wait, and for so long.
    fn new(case: &Case, size: usize, invited: Option<BTreeSet<usize>>, patience: Duration) -> Self {
        let sharing = case.entry.sharing;
        let once = sharing == Sharing::Heartbeat;
        Self { size, invited, once, sharing, patience, state: Mutex::default(), change: Condvar::new() }
    }

    /// Runs of so many jobs, and where their jobs meet, for which the strategy of `threads` is meant to have a worker each.
    pub(super) fn plans(case: &Case, threads: usize) -> Result<Vec<(usize, Self)>, String> {
        let discipline =
            case.entry.discipline(case.contract.parameter.as_deref()).map_err(|error| error.to_string())?;
        let patience = case.contract.patience;
        if case.entry.sharing == Sharing::Heartbeat {
            // Many, so that there is something to share at one heartbeat after the other; fewer where each may take long.
            let plan = |(jobs, factor): (usize, u32)| (jobs * threads, Self::new(case, threads, None, SHORT * factor));
            return Ok([(200, 1), (50, 10), (12, 100)].map(plan).into());
        }
        let all = |jobs: usize| (jobs, Self::new(case, case.entry.workers.at_once(threads, jobs), None, patience));
        let some =
            |jobs: usize, invited: BTreeSet<usize>| (jobs, Self::new(case, invited.len(), Some(invited), patience));
        Ok(match discipline {
            // The second job of a worker waits for the end of the first, which may be waiting for the second. So only first ones meet.
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
            // Who has how many jobs left depends on the clock, but everybody begins with one.
            Discipline::Learned(_) => {
                [threads, 5 * threads].map(|jobs| (jobs, Self { once: true, ..all(jobs).1 })).into()
            }
            // With more jobs than workers, one that has taken several and waits in the first must leave the rest to others.
            _ => vec![all(threads), all(5 * threads)],
        })
    }

    /// Where the first `size` jobs to begin come together.
    pub(super) fn of_first(case: &Case, size: usize) -> Self {
        Self::new(case, size, None, case.contract.patience)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether job `index` is one of those that wait.
    pub(super) fn invites(&self, index: usize) -> bool {
        self.invited.as_ref().is_none_or(|invited| invited.contains(&index))
    }

    /// What job `index` does: waits for the others, and not at all once they have not come or, where one meeting is enough, have come.
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

    /// After a run that has ended: that all were there together, each time where they had to be.
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
