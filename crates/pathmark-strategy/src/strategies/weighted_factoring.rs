//! Weighted factoring: the batches of `factoring`, whose chunk sizes are in proportion to worker speeds given by the
//! user.
//!
//! `pathmark render cornell --strategy weighted-factoring:1:0.5 --threads 4`: the second and the fourth worker are half as fast as the others.
//! Without weights it is `factoring`.
//!
//! Hummel, Schmidt, Uma and Wein, "Load-sharing in heterogeneous systems via weighted factoring", SPAA 1996.
//!
//! Cost: one thread start for each worker; a lock and two clock readings for each of about p log2(n/p) chunks. On equal
//! processors it gains nothing over `factoring`.

use crate::{Clock, Discipline, Entry, LearnedRule, Ledger, Parameter, Weights};

pub(super) const ENTRY: Entry = Entry {
    parameter: Some(Parameter { allowed: "one to eight weights above 0, as in 1:0.5, for the workers in turn", read }),
    ..Entry::learned(
        "weighted-factoring",
        "batches of p chunks, half of the jobs left, sized by the workers' given weights (WF)",
        RULE,
    )
};

const RULE: LearnedRule = LearnedRule { size, clock: Clock::Chunks, weights: Weights::EQUAL };

/// Returns a worker's share of half of the jobs that were left when the batch began.
fn size(ledger: &Ledger, worker: usize) -> f64 {
    ledger.given_weight(worker) * ledger.batch_left() as f64 / (2.0 * ledger.workers() as f64)
}

fn read(value: &str) -> Option<Discipline> {
    Some(Discipline::Learned(LearnedRule { weights: Weights::parse(value)?, ..RULE }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sizes(weights: &str, workers: usize) -> Vec<usize> {
        let Some(Discipline::Learned(rule)) = read(weights) else { panic!("{weights} are weights") };
        let mut ledger = Ledger::new(100, workers, rule.weights);
        let in_turn = (0..workers).cycle();
        in_turn.map_while(|worker| Some(rule.next(&mut ledger, worker)?.len())).collect()
    }

    /// Equal weights give the batches of FAC2: 13, 6, 3, 2 and 1 on four workers. On two workers, weights 3 and 1
    /// become 3/2 and 1/2. Of the first batch's 50 jobs they take ceil(37.5) = 38 and ceil(12.5) = 13, of half of the
    /// other 49 ceil(18.375) = 19 and ceil(6.125) = 7.
    #[test]
    fn chunks_are_in_proportion_to_the_weights() {
        assert_eq!(sizes("1", 4), [[13; 4], [6; 4], [3; 4], [2; 4], [1; 4]].concat());
        assert_eq!(sizes("2:2", 4), sizes("1", 4));
        assert_eq!(sizes("3:1", 2)[..4], [38, 13, 19, 7]);
        assert!(read("1:x").is_none());
    }
}
