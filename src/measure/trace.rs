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

/// What of workers x makespan was not spent in jobs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Idle {
    /// Between jobs, and before the first: what the schedule costs while there is work.
    pub gap_s: f64,
    /// After a worker's last job: what the schedule's balance costs.
    pub tail_s: f64,
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

    /// Seconds outside of jobs, over all workers that had one.
    pub fn idle_s(&self, makespan_s: f64) -> Idle {
        let busy = self.busy_s();
        let mut last = vec![0.0_f64; busy.len()];
        for job in &self.jobs {
            let worker = &mut last[job.worker as usize];
            *worker = worker.max(job.stop_s);
        }
        let tail_s: f64 = last.iter().map(|last| makespan_s - last).sum();
        let gap_s = busy.len() as f64 * makespan_s - busy.iter().sum::<f64>() - tail_s;
        Idle { gap_s, tail_s }
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
        // Until 4: worker 0 works 1.5, waits between 1 and 1.0 not at all and 2.5 at the end; worker 1 has a tail of 1.
        assert_eq!(trace.idle_s(4.0), Idle { gap_s: 0.0, tail_s: 3.5 });
        let late = Trace { jobs: vec![span(0, 0.5, 1.0), span(0, 2.0, 3.0)] };
        assert_eq!(late.idle_s(3.25), Idle { gap_s: 1.5, tail_s: 0.25 });
        let even = Trace { jobs: vec![span(0, 0.0, 1.0), span(0, 1.0, 5.0)] };
        assert_eq!(even.median_duration_s(), Some(2.5));
        assert!(Trace::default().busy_s().is_empty() && Trace::default().median_duration_s().is_none());
    }
}
