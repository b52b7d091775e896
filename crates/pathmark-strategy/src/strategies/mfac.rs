//! mFAC: factoring with a known deviation of job costs, whose chunks can be computed beforehand.
//!
//! `pathmark render cornell --strategy mfac:50 --threads 4`: the standard deviation of the jobs' costs is 50 % of their mean; without a number
//! it is 100 %.
//!
//! Hummel, Schonberg and Flynn, "Factoring: a method for scheduling parallel loops", Communications of the ACM 35(8),
//! 1992: a batch leaves enough work to balance its p chunks if they turn out expensive. With R jobs left,
//! b = p s / (2 sqrt(R)) for a coefficient of variation s. A chunk has R / (x p) jobs. In the first batch
//! x = 1 + b^2 + b sqrt(b^2 + 2), in the others x = 2 + b^2 + b sqrt(b^2 + 4). Korndörfer and others, "LB4OMP: a
//! dynamic load balancing library for multithreaded applications", IEEE TPDS 33, 2022, replace the lock by a counter
//! and call that mFAC. Every chunk rule here uses a counter.
//!
//! Cost: one thread start for each worker, one atomic addition for each chunk, and the list of chunks.

use crate::{ChunkRule, Discipline, Entry, Handout, Parameter};

pub(super) const ENTRY: Entry = Entry {
    parameter: Some(Parameter { allowed: "a whole number: the deviation of costs in % of their mean", read }),
    discipline: Discipline::Chunks(ChunkRule { size, parameter: 100 }),
    ..Entry::chunks("mfac", "batches of p equal chunks, sized for a given deviation of job costs (mFAC)", size)
};

fn size(handout: &Handout) -> usize {
    let (mut left, mut size) = (handout.jobs, 1);
    for batch in 0..=handout.chunks / handout.workers {
        size = of_batch(left, handout.workers, handout.parameter, batch == 0);
        left = left.saturating_sub(size * handout.workers);
    }
    size
}

/// Returns the chunk size of a batch that begins with `left` jobs left.
fn of_batch(left: usize, workers: usize, deviation: usize, is_first: bool) -> usize {
    let (left, workers) = (left as f64, workers as f64);
    let b = workers * deviation as f64 / (200.0 * left.max(1.0).sqrt());
    let divisor =
        if is_first { 1.0 + b * b + b * (b * b + 2.0).sqrt() } else { 2.0 + b * b + b * (b * b + 4.0).sqrt() };
    ((left / (divisor * workers)).ceil() as usize).max(1)
}

fn read(value: &str) -> Option<Discipline> {
    let parameter = value.parse().ok().filter(|deviation: &usize| *deviation <= 100_000)?;
    Some(Discipline::Chunks(ChunkRule { size, parameter }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sizes(parameter: usize, jobs: usize, workers: usize) -> Vec<usize> {
        ChunkRule { size, parameter }.chunks(jobs, workers).map(|chunk| chunk.len()).collect()
    }

    /// Equal jobs go out in one batch. With s = 1, p = 2 and R = 100, b is 0.1 and x = 1.01 + 0.1 sqrt(2.01) = 1.1518,
    /// so chunks have ceil(43.41) = 44 jobs. 12 are left: b = 1 / sqrt(12), x = 2.0833 + 0.28868 sqrt(4.0833) = 2.6667,
    /// and 12 / 5.3333 = 2.25.
    #[test]
    fn batches_are_those_of_the_formula() {
        assert_eq!(sizes(0, 100, 4), [25; 4]);
        assert_eq!(sizes(100, 100, 2)[..4], [44, 44, 3, 3]);
        assert!(sizes(400, 100, 2)[0] < sizes(100, 100, 2)[0]);
        assert!(read("50").is_some() && ["", "-1", "x", "1.5", "100001"].iter().all(|text| read(text).is_none()));
    }
}
