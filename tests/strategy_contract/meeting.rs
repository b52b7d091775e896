//! Jobs that wait for each other, which shows how many can run at the same time.

use std::sync::{Barrier, Condvar, Mutex};
use std::time::Duration;

use pathmark::strategy::{Discipline, Entry, Sharing};

/// How long a job waits for others where they may never come.
const PATIENCE: Duration = Duration::from_millis(2);

/// A place where `workers` jobs at a time wait until all of them are there.
pub(crate) struct Meeting {
    workers: usize,
    sharing: Sharing,
    barrier: Barrier,
    present: Mutex<Present>,
    change: Condvar,
}

#[derive(Default)]
struct Present {
    now: usize,
    met: bool,
}

impl Meeting {
    /// For jobs that `entry`'s strategy runs.
    pub(crate) fn new(entry: &Entry, workers: usize) -> Self {
        Self {
            workers,
            sharing: entry.sharing,
            barrier: Barrier::new(workers),
            present: Mutex::default(),
            change: Condvar::new(),
        }
    }

    /// What a job does. Each group of `workers` jobs waits for its last member, for ever if it must. Where waiting for ever is not
    /// promised to end, a job waits a little while, and not at all once `workers` jobs have been here together.
    pub(crate) fn wait(&self) {
        if self.sharing == Sharing::AtOnce {
            self.barrier.wait();
            return;
        }
        let mut present = self.present.lock().unwrap();
        present.now += 1;
        present.met |= present.now == self.workers;
        self.change.notify_all();
        let (mut present, _) = self.change.wait_timeout_while(present, PATIENCE, |present| !present.met).unwrap();
        present.now -= 1;
    }

    /// After a run that has ended: whether all were there together.
    pub(crate) fn met(&self) -> bool {
        self.sharing == Sharing::AtOnce || self.present.lock().unwrap().met
    }
}

/// Numbers of jobs that `entry`'s strategy can bring to a meeting.
pub(crate) fn jobs(entry: &Entry, workers: usize) -> Vec<usize> {
    if entry.sharing == Sharing::Heartbeat {
        // Many, so that there is something to share at one heartbeat after the other.
        return vec![200 * workers];
    }
    match (entry.discipline)(None).unwrap() {
        // The second job of a chunk waits for the end of the first, which may be waiting for the second.
        Discipline::Chunks(rule) if rule.chunks(5 * workers, workers).any(|chunk| chunk.len() > 1) => vec![workers],
        // With more jobs than workers, one that has taken several and waits in the first must leave the rest to others.
        _ => vec![workers, 5 * workers],
    }
}
