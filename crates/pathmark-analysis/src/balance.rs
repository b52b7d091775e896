//! Balance of one run: the workers' time in jobs, in the gaps between them, and in waiting for the last job.
//!
//! p workers have p T seconds in total over a makespan T. Each second is one of three: *busy* inside a job; *gap*,
//! before a job while this worker still has one to run (starting up, fetching a job, being descheduled); *tail*, after
//! the worker's last job. The three add up to p T. Load imbalance is max busy / mean busy - 1 (O. Pearce and others,
//! "Quantifying the effectiveness of load balance algorithms", ICS 2012). All times are in seconds since the run's
//! start.

/// One job's time: its worker, its start and its stop.
pub type Span = (usize, f64, f64);

/// The time of one worker, by its use.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Share {
    pub jobs: usize,
    pub busy_s: f64,
    pub gap_s: f64,
    /// Seconds from its last job's end to the makespan; all of it for a worker without a job.
    pub tail_s: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Balance {
    pub makespan_s: f64,
    pub workers: Vec<Share>,
}

/// The balance of a run of `workers` workers.
///
/// `None` without workers, for a makespan that is not positive and finite, or for impossible spans: of a worker that
/// does not exist, with a stop before the start, outside the run, or overlapping on one worker. Rounding errors up to
/// 1e-9 of the makespan are allowed.
pub fn of_spans(spans: impl IntoIterator<Item = Span>, makespan_s: f64, workers: usize) -> Option<Balance> {
    if workers == 0 || !(makespan_s > 0.0 && makespan_s.is_finite()) {
        return None;
    }
    let mut spans: Vec<Span> = spans.into_iter().collect();
    spans.sort_by(|a, b| a.1.total_cmp(&b.1));
    let slack = 1e-9 * makespan_s;
    let mut shares = vec![Share::default(); workers];
    let mut stops = vec![0.0; workers];
    for (worker, start_s, stop_s) in spans {
        let (share, last) = (shares.get_mut(worker)?, stops.get_mut(worker)?);
        // Written so that NaN fails.
        let possible = start_s >= *last - slack && stop_s >= start_s && stop_s <= makespan_s + slack;
        if !possible {
            return None;
        }
        share.jobs += 1;
        share.busy_s += stop_s - start_s;
        share.gap_s += start_s - *last;
        *last = stop_s;
    }
    for (share, last) in shares.iter_mut().zip(stops) {
        share.tail_s = makespan_s - last;
    }
    Some(Balance { makespan_s, workers: shares })
}

/// Returns the share of the processors' time in which a job was there to run, in [0, 1]. It is the mean over the run of
/// the smaller of running jobs and processors, divided by the processors. If workers share processors, their busy time
/// is no measure of it, since it includes the time spent waiting for a processor.
pub fn processors_in_use(spans: impl IntoIterator<Item = Span>, makespan_s: f64, processors: usize) -> f64 {
    let ends = spans.into_iter().flat_map(|(_, start_s, stop_s)| [(start_s, 1), (stop_s, -1)]);
    let mut ends: Vec<(f64, isize)> = ends.collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut used_s, mut since_s, mut jobs) = (0.0, 0.0, 0_isize);
    for (at_s, change) in ends {
        used_s += (at_s - since_s) * jobs.min(processors as isize) as f64;
        (since_s, jobs) = (at_s, jobs + change);
    }
    used_s / (processors as f64 * makespan_s)
}

impl Balance {
    /// Seconds in jobs, of all workers.
    pub fn busy_s(&self) -> f64 {
        self.workers.iter().map(|share| share.busy_s).sum()
    }

    /// Seconds before and between jobs, of all workers.
    pub fn gap_s(&self) -> f64 {
        self.workers.iter().map(|share| share.gap_s).sum()
    }

    /// Seconds after the last jobs, of all workers.
    pub fn tail_s(&self) -> f64 {
        self.workers.iter().map(|share| share.tail_s).sum()
    }

    pub fn jobs(&self) -> usize {
        self.workers.iter().map(|share| share.jobs).sum()
    }

    /// The share of the workers' time that went into jobs, in [0, 1].
    pub fn utilisation(&self) -> f64 {
        self.busy_s() / (self.workers.len() as f64 * self.makespan_s)
    }

    /// max busy / mean busy - 1: 0 for equal loads, p - 1 if one worker ran all jobs. `None` if no worker was busy.
    pub fn imbalance(&self) -> Option<f64> {
        let mean = self.busy_s() / self.workers.len() as f64;
        let most = self.workers.iter().map(|share| share.busy_s).fold(0.0, f64::max);
        (mean > 0.0).then(|| most / mean - 1.0)
    }

    /// Seconds of gap per job: the cost of handing out one job. `None` without jobs.
    pub fn overhead_per_job_s(&self) -> Option<f64> {
        (self.jobs() > 0).then(|| self.gap_s() / self.jobs() as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gap, busy and tail add up to the workers' time.
    fn assert_complete(balance: &Balance) {
        let sum = balance.busy_s() + balance.gap_s() + balance.tail_s();
        let time = balance.workers.len() as f64 * balance.makespan_s;
        assert!((sum - time).abs() <= 1e-12 * time, "{sum} of {time}");
    }

    /// Three workers on two processors: two jobs at a time for 2 s, three for 1 s, one for 1 s.
    #[test]
    fn jobs_that_wait_for_a_processor_use_none() {
        let spans = [(0, 0.0, 3.0), (1, 0.0, 4.0), (2, 2.0, 3.0)];
        assert_eq!(processors_in_use(spans, 4.0, 2), (2.0 * 3.0 + 1.0) / 8.0);
        assert_eq!(processors_in_use([], 4.0, 2), 0.0);
    }

    #[test]
    fn times_of_a_run_done_by_hand() {
        // Worker 0: idle 0.5, job 1.5, idle 0.25, job 1.75. Worker 1: job 2, then nothing for 2. In any order.
        let balance = of_spans([(0, 2.25, 4.0), (1, 0.0, 2.0), (0, 0.5, 2.0)], 4.0, 2).unwrap();
        assert_eq!(balance.workers[0], Share { jobs: 2, busy_s: 3.25, gap_s: 0.75, tail_s: 0.0 });
        assert_eq!(balance.workers[1], Share { jobs: 1, busy_s: 2.0, gap_s: 0.0, tail_s: 2.0 });
        assert_eq!(balance.utilisation(), 5.25 / 8.0);
        assert_eq!(balance.imbalance(), Some(3.25 / 2.625 - 1.0));
        assert_eq!(balance.overhead_per_job_s(), Some(0.25));
        assert_complete(&balance);
    }

    #[test]
    fn many_jobs_add_up_all_the_same() {
        let spans =
            (0..3000).map(|i| (i % 3, f64::from(i as u32 / 3) * 0.001 + 0.0001, f64::from(i as u32 / 3 + 1) * 0.001));
        let balance = of_spans(spans, 1.3, 3).unwrap();
        assert!((balance.overhead_per_job_s().unwrap() - 0.0001).abs() < 1e-12);
        assert!(balance.imbalance().unwrap().abs() < 1e-9);
        assert_complete(&balance);
    }

    #[test]
    fn a_worker_without_a_job_is_all_tail() {
        let balance = of_spans([(0, 0.0, 2.0)], 2.0, 2).unwrap();
        assert_eq!(balance.workers[1], Share { jobs: 0, busy_s: 0.0, gap_s: 0.0, tail_s: 2.0 });
        assert_eq!((balance.utilisation(), balance.imbalance()), (0.5, Some(1.0)));
    }

    #[test]
    fn degenerate_input_has_no_answer() {
        let empty = of_spans([], 1.0, 2).unwrap();
        assert_eq!((empty.utilisation(), empty.tail_s(), empty.jobs()), (0.0, 2.0, 0));
        assert_eq!((empty.imbalance(), empty.overhead_per_job_s()), (None, None));
        assert_eq!(of_spans([], 1.0, 0), None);
        assert_eq!(of_spans([], 0.0, 1), None);
        for impossible in
            [(1, 0.0, 1.0), (0, 1.0, 0.5), (0, -0.1, 1.0), (0, 0.0, 2.1), (0, f64::NAN, 1.0), (0, 0.0, f64::NAN)]
        {
            assert_eq!(of_spans([impossible], 2.0, 1), None, "{impossible:?}");
        }
        assert_eq!(of_spans([(0, 0.0, 1.0), (0, 0.9, 2.0)], 2.0, 1), None);
    }
}
