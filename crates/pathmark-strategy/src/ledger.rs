//! Learned chunk sizes: a record of each worker's speed so far, and the next chunk that follows from it.
//!
//! A [`LearnedRule`] is pure: its chunks depend only on the reported times and their order. So the simulator can replay
//! it with simulated times, and the strategies add only a lock and a clock.

use std::ops::Range;

/// The rule for the size of a free worker's next chunk, given the measurements of all workers.
#[derive(Debug, Clone, Copy)]
pub struct LearnedRule {
    /// Number of jobs in a worker's next chunk. [`LearnedRule::next`] rounds it up and clamps it to at least 1 and at
    /// most the number of jobs left.
    pub size: fn(ledger: &Ledger, worker: usize) -> f64,
    /// When a worker reads the clock.
    pub clock: Clock,
    /// The workers' relative speeds, as far as they are known beforehand.
    pub weights: Weights,
}

/// When a worker reads the clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// Before and after each chunk.
    Chunks,
    /// Before and after each job, for rules that need to know how much jobs differ.
    Jobs,
}

/// Relative speeds of workers. Workers take the values in turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    values: [f64; Self::MOST],
    count: usize,
}

impl Weights {
    /// Largest number of values.
    pub const MOST: usize = 8;

    /// Equal weights for all workers.
    pub const EQUAL: Self = Self { values: [1.0; Self::MOST], count: 1 };

    /// Parses one to eight numbers above 0 with colons between them, such as `1:0.5`; `None` for any other text.
    pub fn parse(text: &str) -> Option<Self> {
        let mut weights = Self { count: 0, ..Self::EQUAL };
        for number in text.split(':') {
            let value: f64 = number.parse().ok().filter(|value: &f64| value.is_finite() && *value > 0.0)?;
            *weights.values.get_mut(weights.count)? = value;
            weights.count += 1;
        }
        Some(weights)
    }

    fn of(&self, worker: usize) -> f64 {
        self.values[worker % self.count]
    }
}

/// A worker's measurements of jobs that it has run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Seen {
    /// Number of jobs.
    pub jobs: usize,
    /// Total seconds of these jobs.
    pub seconds: f64,
    /// Sum of the squared seconds of each job; 0 if only chunks were timed ([`Clock::Chunks`]).
    pub squares: f64,
}

impl Seen {
    /// Adds a job that took `seconds`.
    pub fn add(&mut self, seconds: f64) {
        self.jobs += 1;
        self.seconds += seconds;
        self.squares += seconds * seconds;
    }
}

/// Collects the seconds of jobs, one value for each job.
impl FromIterator<f64> for Seen {
    fn from_iter<I: IntoIterator<Item = f64>>(seconds: I) -> Self {
        let mut seen = Self::default();
        for seconds in seconds {
            seen.add(seconds);
        }
        seen
    }
}

/// The measurements of one worker.
#[derive(Debug, Clone, Copy, Default)]
struct History {
    /// Chunks that it has done.
    chunks: u32,
    /// Sums over its chunks of k times the seconds and of k times the jobs, where k counts the chunks from 1. Late
    /// chunks therefore count more.
    late_seconds: f64,
    late_jobs: f64,
    all: Seen,
}

/// The state of a run: the jobs that have been handed out, and the measurements of finished jobs.
#[derive(Debug, Clone)]
pub struct Ledger {
    jobs: usize,
    start: usize,
    chunks: usize,
    given: Weights,
    workers: Vec<History>,
    /// Jobs that were left when the batch of the next chunk began. A batch has as many chunks as there are workers.
    batch_left: usize,
    /// The workers' learned weights when that batch began.
    batch_weights: Vec<f64>,
}

impl Ledger {
    /// Returns a ledger with no jobs handed out. `workers` is at least 1 unless there are no jobs.
    pub fn new(jobs: usize, workers: usize, given: Weights) -> Self {
        let histories = vec![History::default(); workers];
        Self {
            jobs,
            start: 0,
            chunks: 0,
            given,
            workers: histories,
            batch_left: jobs,
            batch_weights: vec![1.0; workers],
        }
    }

    /// Records a worker's measurements of its last chunk.
    pub fn note(&mut self, worker: usize, seen: Seen) {
        let history = &mut self.workers[worker];
        if seen.jobs > 0 {
            history.chunks += 1;
            history.late_seconds += f64::from(history.chunks) * seen.seconds;
            history.late_jobs += f64::from(history.chunks) * seen.jobs as f64;
            history.all.jobs += seen.jobs;
            history.all.seconds += seen.seconds;
            history.all.squares += seen.squares;
        }
    }

    /// Returns the number of workers.
    pub fn workers(&self) -> usize {
        self.workers.len()
    }

    /// Returns the total number of jobs.
    pub fn jobs(&self) -> usize {
        self.jobs
    }

    /// Returns the number of jobs that have not been handed out.
    pub fn left(&self) -> usize {
        self.jobs - self.start
    }

    /// Returns the number of jobs that were left when the current batch began.
    pub fn batch_left(&self) -> usize {
        self.batch_left
    }

    /// Returns a worker's given weight, scaled so that the weights of all workers add up to the number of workers.
    pub fn given_weight(&self, worker: usize) -> f64 {
        let sum: f64 = (0..self.workers()).map(|worker| self.given.of(worker)).sum();
        self.given.of(worker) * self.workers() as f64 / sum
    }

    /// Returns a worker's learned weight: its speed so far over the mean speed of all workers with a known speed. Speed
    /// is jobs per second, and late chunks count more. The weights of all workers add up to the number of workers. A
    /// worker whose speed is unknown has weight 1.
    pub fn learned_weight(&self, worker: usize) -> f64 {
        let known = || self.workers.iter().filter_map(History::speed);
        let count = known().count();
        if count == 0 {
            return 1.0;
        }
        // A worker with unknown speed counts as average, so the weights still add up to the number of workers.
        self.workers[worker].speed().map_or(1.0, |speed| speed * count as f64 / known().sum::<f64>())
    }

    /// Returns a worker's learned weight at the beginning of the current batch.
    pub fn batch_weight(&self, worker: usize) -> f64 {
        self.batch_weights[worker]
    }

    /// Returns mean and variance of the seconds of a worker's jobs so far; `None` if it has done fewer than two, or if
    /// they took no measurable time.
    pub fn mean_and_variance(&self, worker: usize) -> Option<(f64, f64)> {
        let all = self.workers[worker].all;
        let (n, mean) = (all.jobs as f64, all.seconds / all.jobs as f64);
        (all.jobs > 1 && mean > 0.0).then(|| (mean, ((all.squares - n * mean * mean) / (n - 1.0)).max(0.0)))
    }
}

impl History {
    /// Returns jobs per second, where late chunks count more; `None` without measurements, or if the jobs took no time.
    fn speed(&self) -> Option<f64> {
        Some(self.late_jobs / self.late_seconds).filter(|speed| speed.is_finite())
    }
}

impl LearnedRule {
    /// Returns a worker's next chunk, or `None` when all jobs have been handed out.
    pub fn next(&self, ledger: &mut Ledger, worker: usize) -> Option<Range<usize>> {
        let left = ledger.left();
        if left == 0 {
            return None;
        }
        if ledger.chunks.is_multiple_of(ledger.workers()) {
            ledger.batch_left = left;
            for worker in 0..ledger.workers() {
                ledger.batch_weights[worker] = ledger.learned_weight(worker);
            }
        }
        // A NaN becomes 0 in the cast, and then 1.
        let size = ((self.size)(ledger, worker).ceil() as usize).clamp(1, left);
        let chunk = ledger.start..ledger.start + size;
        ledger.start = chunk.end;
        ledger.chunks += 1;
        Some(chunk)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_read_and_add_up_to_the_workers() {
        let weights = Weights::parse("1:0.5").unwrap();
        let ledger = Ledger::new(100, 4, weights);
        let given: Vec<f64> = (0..4).map(|worker| ledger.given_weight(worker)).collect();
        assert_eq!(given, [4.0 / 3.0, 2.0 / 3.0, 4.0 / 3.0, 2.0 / 3.0]);
        assert!(Weights::parse("1:2:3:4:5:6:7:8").is_some());
        for text in ["", "0", "-1", "1:", "x", "nan", "inf", "1,2", "1:2:3:4:5:6:7:8:9"] {
            assert_eq!(Weights::parse(text), None, "{text}");
        }
    }

    /// Worker 0 needs 1 s a job and then 3 s a job: (1 * 4 + 2 * 6) / (1 * 4 + 2 * 2) = 2 s. Worker 1 needs 1 s a job.
    /// Their speeds are 1/2 and 1, so their weights are 2/3 and 4/3. Worker 2 has done nothing.
    #[test]
    fn late_chunks_count_more() {
        let mut ledger = Ledger::new(100, 3, Weights::EQUAL);
        assert_eq!(ledger.learned_weight(0), 1.0);
        ledger.note(0, Seen { jobs: 4, seconds: 4.0, squares: 0.0 });
        ledger.note(0, Seen { jobs: 2, seconds: 6.0, squares: 0.0 });
        ledger.note(1, Seen { jobs: 5, seconds: 5.0, squares: 0.0 });
        let weights: Vec<f64> = (0..3).map(|worker| ledger.learned_weight(worker)).collect();
        assert!((weights[0] - 2.0 / 3.0).abs() < 1e-15 && (weights[1] - 4.0 / 3.0).abs() < 1e-15, "{weights:?}");
        assert_eq!(weights[2], 1.0);
        // Jobs that are too short for the clock give no speed.
        ledger.note(2, Seen { jobs: 5, seconds: 0.0, squares: 0.0 });
        assert_eq!((ledger.learned_weight(2), ledger.mean_and_variance(2)), (1.0, None));
    }

    /// 1, 2, 3 and 6 s: the mean is 3, and the squared deviations 4 + 1 + 0 + 9 are divided by three.
    #[test]
    fn jobs_that_differ_have_a_variance() {
        let mut ledger = Ledger::new(9, 1, Weights::EQUAL);
        ledger.note(0, Seen::from_iter([1.0]));
        assert_eq!(ledger.mean_and_variance(0), None);
        ledger.note(0, Seen::from_iter([2.0, 3.0, 6.0]));
        let (mean, variance) = ledger.mean_and_variance(0).unwrap();
        assert!(mean == 3.0 && (variance - 14.0 / 3.0).abs() < 1e-14, "{mean} {variance}");
    }

    /// For any size that a rule returns, the chunks are contiguous and cover all jobs.
    #[test]
    fn sizes_that_make_no_sense_are_corrected() {
        let sizes: [fn(&Ledger, usize) -> f64; 5] =
            [|_, _| f64::NAN, |_, _| f64::INFINITY, |_, _| -3.0, |_, _| 0.2, |_, _| 2.5];
        for size in sizes {
            let rule = LearnedRule { size, clock: Clock::Chunks, weights: Weights::EQUAL };
            let mut ledger = Ledger::new(7, 2, Weights::EQUAL);
            let mut end = 0;
            while let Some(chunk) = rule.next(&mut ledger, 1) {
                assert!(chunk.start == end && chunk.end > end, "{chunk:?} after {end}");
                end = chunk.end;
            }
            assert_eq!(end, 7);
        }
    }
}
