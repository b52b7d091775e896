//! Adaptive weighted factoring by batches: weighted factoring with measured weights, updated at each batch.
//!
//! `pathmark render cornell --strategy awf-b --threads 4`
//!
//! Cariño and Banicescu, "Dynamic load balancing with adaptive factoring methods in scientific applications", The
//! Journal of Supercomputing 44, 2008. A worker's speed is its jobs per second, where its k-th chunk counts k times.
//! The first batch has equal weights.
//!
//! Cost: one thread start for each worker; a lock and two clock readings for each of about p log2(n/p) chunks. On equal
//! processors it gains nothing over `factoring`: the measured speeds only reflect which jobs a worker happened to have.

use crate::{Clock, Entry, LearnedRule, Ledger, Weights};

pub(super) const ENTRY: Entry = Entry::learned(
    "awf-b",
    "batches of p chunks, half of the jobs left, sized by worker speeds measured before each batch (AWF-B)",
    LearnedRule { size, clock: Clock::Chunks, weights: Weights::EQUAL },
);

/// Returns a worker's share, by its speed up to then, of half of the jobs that were left when the batch began.
fn size(ledger: &Ledger, worker: usize) -> f64 {
    ledger.batch_weight(worker) * ledger.batch_left() as f64 / (2.0 * ledger.workers() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Discipline, Seen};

    /// 160 jobs on two workers; the second is a third as fast. The first batch is 40 and 40. When the second batch
    /// begins, only the first worker's speed is known: 20 and 20, although the second worker reports its speed
    /// meanwhile. The third batch is 3/2 and 1/2 of 10.
    #[test]
    fn weights_are_those_of_the_batchs_beginning() {
        let Discipline::Learned(rule) = ENTRY.discipline else { panic!("it learns") };
        let mut ledger = Ledger::new(160, 2, rule.weights);
        let mut take = |worker: usize, last: usize, second_per_job: f64| {
            ledger.note(worker, Seen { jobs: last, seconds: last as f64 * second_per_job, squares: 0.0 });
            rule.next(&mut ledger, worker).unwrap().len()
        };
        assert_eq!((take(0, 0, 1.0), take(1, 0, 1.0)), (40, 40));
        assert_eq!(take(0, 40, 1.0), 20, "of one worker's speed alone nothing follows");
        assert_eq!(take(1, 40, 3.0), 20);
        assert_eq!((take(0, 20, 1.0), take(1, 20, 3.0)), (15, 5));
    }
}
