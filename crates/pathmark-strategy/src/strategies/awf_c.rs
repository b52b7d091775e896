//! Adaptive weighted factoring by chunks: each chunk is the worker's share, by its speed so far, of half of the jobs
//! that are left when it asks.
//!
//! `pathmark render cornell --strategy awf-c --threads 4`
//!
//! Cariño and Banicescu, "Dynamic load balancing with adaptive factoring methods in scientific applications", The
//! Journal of Supercomputing 44, 2008. A worker's speed is its jobs per second, where its k-th chunk counts k times.
//!
//! Cost: one thread start for each worker; a lock and two clock readings for each of about 2p ln(n/p) chunks.

use crate::{Clock, Entry, LearnedRule, Ledger, Weights};

pub(super) const ENTRY: Entry = Entry::learned(
    "awf-c",
    "a free worker takes its share of half of the jobs left, by the speeds measured so far (AWF-C)",
    LearnedRule { size, clock: Clock::Chunks, weights: Weights::EQUAL },
);

/// Returns a worker's share of half of the jobs left.
fn size(ledger: &Ledger, worker: usize) -> f64 {
    ledger.learned_weight(worker) * ledger.left() as f64 / (2.0 * ledger.workers() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Discipline, Seen};

    /// 160 jobs on two workers: chunks of 160/4 and 120/4. Then the speeds are 1 and 1/3, so the weights are 3/2 and
    /// 1/2.
    #[test]
    fn each_chunk_follows_the_latest_speeds() {
        let Discipline::Learned(rule) = ENTRY.discipline else { panic!("it learns") };
        let mut ledger = Ledger::new(160, 2, rule.weights);
        assert_eq!((rule.next(&mut ledger, 0), rule.next(&mut ledger, 1)), (Some(0..40), Some(40..70)));
        ledger.note(0, Seen { jobs: 40, seconds: 40.0, squares: 0.0 });
        ledger.note(1, Seen { jobs: 30, seconds: 90.0, squares: 0.0 });
        // ceil(1.5 * 22.5) = 34 of 90, then ceil(0.5 * 14) = 7 of 56.
        assert_eq!((rule.next(&mut ledger, 0), rule.next(&mut ledger, 1)), (Some(70..104), Some(104..111)));
    }
}
