//! Traces of runs: which worker ran which job when.

use crate::analysis::balance::{Balance, of_spans};
use std::collections::BTreeMap;

/// The time of one job, in seconds since the run's start.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JobSpan {
    /// The worker, numbered in the order in which workers ran their first jobs.
    pub worker: u32,
    pub start_s: f64,
    /// Its end.
    pub stop_s: f64,
}

impl JobSpan {
    pub fn duration_s(&self) -> f64 {
        self.stop_s - self.start_s
    }

    /// The same job in a run that started `offset_s` seconds earlier.
    #[must_use]
    pub(super) fn later_by(&self, offset_s: f64) -> Self {
        Self { start_s: self.start_s + offset_s, stop_s: self.stop_s + offset_s, ..*self }
    }
}

/// The spans of all jobs, in index order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trace {
    pub jobs: Vec<JobSpan>,
}

impl Trace {
    /// How `workers` workers spent their time in a run of that makespan; `None` for impossible spans.
    pub fn balance(&self, makespan_s: f64, workers: usize) -> Option<Balance> {
        of_spans(self.jobs.iter().map(|job| (job.worker as usize, job.start_s, job.stop_s)), makespan_s, workers)
    }

    /// Seconds from the run's start to each worker's first job, over all workers that had one.
    pub fn starting_s(&self) -> f64 {
        let mut first: BTreeMap<u32, f64> = BTreeMap::new();
        for JobSpan { worker, start_s, .. } in &self.jobs {
            first.entry(*worker).and_modify(|first| *first = first.min(*start_s)).or_insert(*start_s);
        }
        first.into_values().sum()
    }

    /// The duration of each job, in index order.
    pub fn durations_s(&self) -> Vec<f64> {
        self.jobs.iter().map(JobSpan::duration_s).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worker 1 begins half a second late, and worker 0 has a second job, in any order of the jobs.
    #[test]
    fn each_worker_starts_with_its_first_job() {
        let span = |(worker, start_s): (u32, f64)| JobSpan { worker, start_s, stop_s: start_s + 0.25 };
        let trace = Trace { jobs: [(0, 1.0), (1, 0.5), (0, 0.125), (1, 0.75)].map(span).to_vec() };
        assert_eq!((trace.starting_s(), Trace::default().starting_s()), (0.625, 0.0));
    }
}
