//! Factoring: half of the jobs are handed out in p equal chunks, then half of the rest, and so on.
//!
//! `pathmark render cornell --strategy factoring --threads 4`
//!
//! Hummel, Schonberg and Flynn, "Factoring: a method for scheduling parallel loops", Communications of the ACM 35(8),
//! 1992, in the form FAC2, which needs no knowledge of the jobs.
//!
//! Cost: one thread start for each worker, one atomic addition for each of about p log2(n/p) chunks. Every batch leaves
//! as many jobs as it hands out, so later batches can balance even a chunk that is twice as expensive as the others.

use crate::{Entry, Handout};

pub(super) const ENTRY: Entry =
    Entry::chunks("factoring", "batches of p equal chunks, each batch half of the jobs left (FAC2)", size);

/// Returns 1/(2p), rounded up, of the jobs that were left when the chunk's batch began.
pub(super) fn size(handout: &Handout) -> usize {
    let (mut left, mut size) = (handout.jobs, 1);
    for _ in 0..=handout.chunks / handout.workers {
        size = left.div_ceil(2 * handout.workers).max(1);
        left = left.saturating_sub(size * handout.workers);
    }
    size
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ChunkRule;

    /// 100 jobs on 4 workers: batches of 13, 6, 3, 2 and 1 (100 - 52 = 48, 48 - 24 = 24, 24 - 12 = 12, 12 - 8 = 4).
    #[test]
    fn batches_halve_the_remaining_jobs() {
        let rule = ChunkRule { size, parameter: 1 };
        let sizes: Vec<usize> = rule.chunks(100, 4).map(|chunk| chunk.len()).collect();
        assert_eq!(sizes, [[13; 4], [6; 4], [3; 4], [2; 4], [1; 4]].concat());
    }
}
