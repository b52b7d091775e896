//! Who did what when.

/// One job's time, in seconds since the run's start.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JobSpan {
    /// The worker, numbered in the order in which workers showed up.
    pub worker: u32,
    /// When it started.
    pub start_s: f64,
    /// When it stopped.
    pub stop_s: f64,
}

impl JobSpan {
    /// How long it took.
    pub fn duration_s(&self) -> f64 {
        self.stop_s - self.start_s
    }
}

/// The spans of all jobs, in index order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trace {
    /// The spans.
    pub jobs: Vec<JobSpan>,
}

impl Trace {
    /// Seconds of work of each worker.
    pub fn busy_s(&self) -> Vec<f64> {
        let workers = self.jobs.iter().map(|job| job.worker as usize + 1).max().unwrap_or(0);
        let mut busy = vec![0.0; workers];
        for job in &self.jobs {
            busy[job.worker as usize] += job.duration_s();
        }
        busy
    }

    /// How long each job took, shortest first.
    pub fn sorted_durations_s(&self) -> Vec<f64> {
        let mut durations: Vec<f64> = self.jobs.iter().map(JobSpan::duration_s).collect();
        durations.sort_by(f64::total_cmp);
        durations
    }

    /// The middle job's time, or the mean of the middle two's; `None` without jobs.
    pub fn median_duration_s(&self) -> Option<f64> {
        median(&mut self.sorted_durations_s())
    }
}

/// The middle value, or the mean of the middle two; `None` without values. Sorts them.
pub fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let (low, high) = (values.get(values.len().checked_sub(1)? / 2)?, values.get(values.len() / 2)?);
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn busy_time_by_worker() {
        let span = |worker, start_s, stop_s| JobSpan { worker, start_s, stop_s };
        let trace = Trace { jobs: vec![span(0, 0.0, 1.0), span(1, 0.0, 3.0), span(0, 1.0, 1.5)] };
        assert_eq!(trace.busy_s(), [1.5, 3.0]);
        assert_eq!(trace.sorted_durations_s(), [0.5, 1.0, 3.0]);
        assert_eq!(trace.median_duration_s(), Some(1.0));
        let even = Trace { jobs: vec![span(0, 0.0, 1.0), span(0, 1.0, 5.0)] };
        assert_eq!(even.median_duration_s(), Some(2.5));
        assert!(Trace::default().busy_s().is_empty() && Trace::default().median_duration_s().is_none());
    }
}
