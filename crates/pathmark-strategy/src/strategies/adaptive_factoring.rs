//! Adaptive factoring: chunk sizes from the mean and the variance of each worker's jobs so far.
//!
//! `pathmark render cornell --strategy adaptive-factoring --threads 4`
//!
//! Banicescu and Liu, "Adaptive factoring: a dynamic scheduling method tuned to the rate of weight changes", HPC 2000.
//! With R jobs left, a worker of mean m and variance v gets (D + 2 T R - sqrt(D^2 + 4 D T R)) / (2 m) jobs. D is the
//! sum of v/m over all workers, and T is 1 over the sum of 1/m. The first chunk must be large enough to measure both:
//! it is a tenth of a worker's equal share, but at least two jobs and at most the share. Mean and variance are of all
//! jobs that a worker has done, because its latest chunk can be too small for a variance.
//!
//! Cost: one thread start for each worker; a lock for each chunk; a clock reading for each job. The more alike the jobs
//! are, the fewer chunks there are.

use crate::{Clock, Entry, LearnedRule, Ledger, Weights};

pub(super) const ENTRY: Entry = Entry::learned(
    "adaptive-factoring",
    "chunk sizes from the mean and variance of the job times of each worker (AF)",
    LearnedRule { size, clock: Clock::Jobs, weights: Weights::EQUAL },
);

fn size(ledger: &Ledger, worker: usize) -> f64 {
    let workers = ledger.workers();
    let Some((mean, _)) = ledger.mean_and_variance(worker) else {
        let equal_share = ledger.jobs() as f64 / workers as f64;
        return (equal_share / 10.0).max(2.0).min(equal_share);
    };
    // A worker without measurements counts as average.
    let known = || (0..workers).filter_map(|worker| ledger.mean_and_variance(worker));
    let of_all = workers as f64 / known().count() as f64;
    let spread = of_all * known().map(|(mean, variance)| variance / mean).sum::<f64>();
    let speed = of_all * known().map(|(mean, _)| 1.0 / mean).sum::<f64>();
    let time = ledger.left() as f64 / speed;
    (spread + 2.0 * time - (spread * (spread + 4.0 * time)).sqrt()) / (2.0 * mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Seen;

    fn told(seconds: [&[f64]; 2]) -> Ledger {
        let mut ledger = Ledger::new(1000, 2, Weights::EQUAL);
        for (worker, own) in seconds.into_iter().enumerate() {
            ledger.note(worker, own.iter().copied().collect::<Seen>());
        }
        ledger
    }

    /// Without variance jobs are shared by speed: 2/3 and 1/3 of 1000.
    #[test]
    fn without_variance_all_that_is_left_is_shared_by_speed() {
        let ledger = told([&[1.0, 1.0], &[2.0, 2.0]]);
        assert!((size(&ledger, 0) - 2000.0 / 3.0).abs() < 1e-9 && (size(&ledger, 1) - 1000.0 / 3.0).abs() < 1e-9);
    }

    /// Means 2 and 2, variances 2 and 2: D = 2, T = 1, so (2 + 2000 - sqrt(4 + 8000)) / 4 = 478.13.
    #[test]
    fn the_more_jobs_differ_the_smaller_the_chunks() {
        let ledger = told([&[1.0, 3.0], &[1.0, 3.0]]);
        assert!((size(&ledger, 0) - (2002.0 - 8004f64.sqrt()) / 4.0).abs() < 1e-9, "{}", size(&ledger, 0));
        // The other worker has no measurements, so it counts as equal to the first.
        assert_eq!(size(&told([&[1.0, 3.0], &[]]), 0), size(&ledger, 0));
        assert_eq!(size(&told([&[], &[]]), 0), 50.0);
        assert_eq!(size(&told([&[9.0], &[1.0, 3.0]]), 0), 50.0, "one job has no variance");
        assert_eq!(size(&Ledger::new(2, 2, Weights::EQUAL), 0), 1.0, "each worker gets one of two jobs");
    }
}
