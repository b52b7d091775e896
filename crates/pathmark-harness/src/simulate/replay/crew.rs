//! The workers of a replay: when each becomes free, and the jobs that it has done.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;
use std::ops::Range;

use super::Replay;
use crate::measure::{JobSpan, Trace};
use crate::simulate::hardware::Hardware;
use crate::simulate::overhead::Overhead;
use crate::strategy::Seen;

/// A point in time, in seconds, with a total order.
#[derive(Debug, Clone, Copy)]
pub(super) struct Time(pub(super) f64);

impl PartialEq for Time {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Time {}

impl PartialOrd for Time {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Time {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// The workers that are free now or later, each on its processor.
pub(super) struct Crew<'a> {
    costs: &'a [f64],
    overhead: &'a Overhead,
    /// The speed of each worker's processor.
    speeds: Vec<f64>,
    free: BinaryHeap<Reverse<(Time, usize)>>,
    spans: Vec<JobSpan>,
    last_s: f64,
    /// When the shared place is free again.
    place_s: f64,
}

impl<'a> Crew<'a> {
    /// The caller starts the workers one after the other; each is free from then on.
    pub(super) fn new(costs: &'a [f64], workers: usize, overhead: &'a Overhead, hardware: &Hardware) -> Self {
        let started_s = |worker: usize| overhead.run_s + (worker + 1) as f64 * overhead.start_s;
        let workers = if costs.is_empty() { 0 } else { workers };
        Self {
            costs,
            overhead,
            speeds: (0..workers).map(|worker| hardware.speed(worker)).collect(),
            free: (0..workers).map(|worker| Reverse((Time(started_s(worker)), worker))).collect(),
            spans: vec![JobSpan::default(); costs.len()],
            last_s: overhead.run_s,
            place_s: 0.0,
        }
    }

    pub(super) fn jobs(&self) -> usize {
        self.costs.len()
    }

    pub(super) fn workers(&self) -> usize {
        self.speeds.len()
    }

    /// Removes and returns the worker that is free first, with the time. [`Crew::ask_again`] puts it back.
    pub(super) fn next_free(&mut self) -> Option<(usize, f64)> {
        self.free.pop().map(|Reverse((time, worker))| (worker, time.0))
    }

    pub(super) fn ask_again(&mut self, worker: usize, time_s: f64) {
        self.free.push(Reverse((Time(time_s), worker)));
    }

    /// Returns when `worker`, which asks at `now_s`, has got `jobs` jobs from the shared place. The place serves one
    /// request after the other.
    pub(super) fn through_shared_place(&mut self, worker: usize, jobs: usize, now_s: f64) -> f64 {
        let begin_s = now_s.max(self.place_s);
        self.place_s = begin_s + jobs as f64 * self.overhead.shared_s;
        self.place_s.max(begin_s + self.overhead.take_s / self.speeds[worker])
    }

    /// Lets `worker` run `jobs` one after the other from `now_s` on, and returns when it has finished.
    pub(super) fn work(&mut self, worker: usize, jobs: impl IntoIterator<Item = usize>, mut now_s: f64) -> f64 {
        let speed = self.speeds[worker];
        for job in jobs {
            let start_s = now_s + self.overhead.job_s / speed;
            now_s = start_s + self.costs[job] / speed;
            self.spans[job] = JobSpan { worker: worker as u32, start_s, stop_s: now_s };
        }
        // A worker that finds no job was started too, and the caller waits for it.
        self.last_s = self.last_s.max(now_s);
        now_s
    }

    pub(super) fn seen(&self, jobs: Range<usize>) -> Seen {
        self.spans[jobs].iter().map(JobSpan::duration_s).collect()
    }

    pub(super) fn into_replay(self) -> Replay {
        Replay { makespan_s: self.last_s, trace: Trace { jobs: self.spans } }
    }
}
