//! Chunks whose sizes depend on how fast the workers have been: what is known of each worker, and who gets what next.
//!
//! A [`LearnedRule`] is pure: its chunks follow from what it has been told in which order. So the simulator replays it with times of its own,
//! and the strategies behind it differ from it only by a lock and a clock.

use std::ops::Range;

/// How large the chunk is that a free worker gets, given what has been seen of all workers.
#[derive(Debug, Clone, Copy)]
pub struct LearnedRule {
    /// Jobs in the next chunk of a worker. What is less than one or more than what is left is corrected by [`LearnedRule::next`].
    pub size: fn(ledger: &Ledger, worker: usize) -> f64,
    /// When a worker looks at its clock.
    pub clock: Clock,
    /// How fast the workers are, as far as that is known beforehand.
    pub weights: Weights,
}

/// When a worker looks at its clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// Before and after each chunk.
    Chunks,
    /// Before and after each job, for rules that need to know how much jobs differ.
    Jobs,
}

/// How fast workers are, relative to each other. Workers take the values in turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    values: [f64; Self::MOST],
    count: usize,
}

impl Weights {
    /// So many values may differ.
    pub const MOST: usize = 8;

    /// All workers are alike.
    pub const EQUAL: Self = Self { values: [1.0; Self::MOST], count: 1 };

    /// From text: one to eight numbers above 0 with colons between them, as `1:0.5`.
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

/// What a worker saw of jobs that it has done.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Seen {
    /// How many they were.
    pub jobs: usize,
    /// Seconds that they took together.
    pub seconds: f64,
    /// The sum of the squares of each one's seconds; 0 if only chunks were timed ([`Clock::Chunks`]).
    pub squares: f64,
}

impl Seen {
    /// One job more.
    pub fn add(&mut self, seconds: f64) {
        self.jobs += 1;
        self.seconds += seconds;
        self.squares += seconds * seconds;
    }
}

/// The seconds of jobs, one after the other.
impl FromIterator<f64> for Seen {
    fn from_iter<I: IntoIterator<Item = f64>>(seconds: I) -> Self {
        let mut seen = Self::default();
        for seconds in seconds {
            seen.add(seconds);
        }
        seen
    }
}

/// What is known of one worker.
#[derive(Debug, Clone, Copy, Default)]
struct History {
    /// Chunks that it has done.
    chunks: u32,
    /// Sums over its chunks of k times their seconds and k times their jobs, where k counts the chunks from 1: late ones weigh more.
    late_seconds: f64,
    late_jobs: f64,
    all: Seen,
}

/// How far the jobs of a run have been handed out, and what has been seen of those that are done.
#[derive(Debug, Clone)]
pub struct Ledger {
    jobs: usize,
    start: usize,
    chunks: usize,
    given: Weights,
    workers: Vec<History>,
    /// Jobs that were left when the batch of the next chunk began; a batch is as many chunks as there are workers.
    batch_left: usize,
    /// The workers' weights when it began.
    batch_weights: Vec<f64>,
}

impl Ledger {
    /// Nothing has been handed out. `workers` is at least 1 unless there are no jobs.
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

    /// Knows what a worker saw of its last chunk.
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

    /// How many workers share the jobs.
    pub fn workers(&self) -> usize {
        self.workers.len()
    }

    /// Jobs in all.
    pub fn jobs(&self) -> usize {
        self.jobs
    }

    /// Jobs that have not been handed out.
    pub fn left(&self) -> usize {
        self.jobs - self.start
    }

    /// Jobs that were left when the present batch began.
    pub fn batch_left(&self) -> usize {
        self.batch_left
    }

    /// A worker's weight as it was given beforehand; those of all workers add up to their number.
    pub fn given_weight(&self, worker: usize) -> f64 {
        let sum: f64 = (0..self.workers()).map(|worker| self.given.of(worker)).sum();
        self.given.of(worker) * self.workers() as f64 / sum
    }

    /// A worker's weight, as its speed so far tells it: jobs a second, late chunks counting more, over the mean of all workers whose speed is
    /// known. Those of all workers add up to their number; it is 1 where nothing is known yet.
    pub fn learned_weight(&self, worker: usize) -> f64 {
        let known = || self.workers.iter().filter_map(History::speed);
        let count = known().count();
        if count == 0 {
            return 1.0;
        }
        // Who has done nothing yet is taken for an average worker, so the weights add up with them, too.
        self.workers[worker].speed().map_or(1.0, |speed| speed * count as f64 / known().sum::<f64>())
    }

    /// A worker's learned weight at the time when the present batch began.
    pub fn batch_weight(&self, worker: usize) -> f64 {
        self.batch_weights[worker]
    }

    /// Mean and variance of the seconds of a worker's jobs so far; `None` if it has done fewer than two.
    pub fn mean_and_variance(&self, worker: usize) -> Option<(f64, f64)> {
        let all = self.workers[worker].all;
        let (n, mean) = (all.jobs as f64, all.seconds / all.jobs as f64);
        (all.jobs > 1 && mean > 0.0).then(|| (mean, ((all.squares - n * mean * mean) / (n - 1.0)).max(0.0)))
    }
}

impl History {
    /// Jobs a second, late chunks counting more; `None` if nothing has been seen, or nothing that took time.
    fn speed(&self) -> Option<f64> {
        Some(self.late_jobs / self.late_seconds).filter(|speed| speed.is_finite())
    }
}

impl LearnedRule {
    /// The next chunk of a worker; `None` when all jobs have been handed out.
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
        // A size that is no number becomes 0 here, and so 1.
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

    /// Worker 0 needs 1 s a job and then 3 s a job: (1 * 4 + 2 * 6) / (1 * 4 + 2 * 2) = 2 s. Worker 1 needs 1 s. Their speeds are 1/2 and 1, so
    /// their weights 2/3 and 4/3. Worker 2 has done nothing.
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
        // Jobs too short for the clock say nothing of speeds.
        ledger.note(2, Seen { jobs: 5, seconds: 0.0, squares: 0.0 });
        assert_eq!((ledger.learned_weight(2), ledger.mean_and_variance(2)), (1.0, None));
    }

    /// 1, 2, 3 and 6 s: mean 3, squared deviations 4 + 1 + 0 + 9, over three.
    #[test]
    fn jobs_that_differ_have_a_variance() {
        let mut ledger = Ledger::new(9, 1, Weights::EQUAL);
        ledger.note(0, Seen::from_iter([1.0]));
        assert_eq!(ledger.mean_and_variance(0), None);
        ledger.note(0, Seen::from_iter([2.0, 3.0, 6.0]));
        let (mean, variance) = ledger.mean_and_variance(0).unwrap();
        assert!(mean == 3.0 && (variance - 14.0 / 3.0).abs() < 1e-14, "{mean} {variance}");
    }

    /// Whatever a rule says, the chunks join up and cover all jobs.
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
