//! Properties of every discipline, for any costs.

use super::*;
use crate::simulate::bounds;
use crate::strategy::{Amount, LearnedRule, Ledger, STRATEGIES, Seen, Start, Stealing, Victim};
use rand::Rng;
use rand_pcg::Pcg32;

/// Every discipline of the table, and every way of stealing.
fn disciplines() -> Vec<(String, Discipline)> {
    let mut all: Vec<(String, Discipline)> =
        STRATEGIES.iter().map(|entry| (entry.name.to_owned(), entry.discipline)).collect();
    for start in [Start::Blocks, Start::Shared(32)] {
        for amount in [Amount::One, Amount::Half] {
            for victim in [Victim::Neighbour, Victim::Random, Victim::Richest] {
                let stealing = Stealing { start, amount, victim };
                all.push((format!("{stealing:?}"), Discipline::Stealing(stealing)));
            }
        }
    }
    all.push(("halving".to_owned(), Discipline::Halving));
    all
}

/// Whether a worker never idles while a job waits: jobs are handed out one by one, or can be taken back.
fn greedy(discipline: Discipline, jobs: usize, workers: usize) -> bool {
    match discipline {
        Discipline::Chunks(rule) => rule.chunks(jobs, workers).all(|chunk| chunk.len() == 1),
        Discipline::InOrder | Discipline::Dealt(_) | Discipline::Learned(_) => workers == 1,
        // `AllAtOnce` is no list schedule, but Graham's argument holds: if a thread has less than a processor, all
        // processors are busy.
        Discipline::Stealing(_) | Discipline::Halving | Discipline::AllAtOnce => true,
    }
}

/// Costs between 1 and 2^-16 whose logarithm is uniform: a few expensive jobs among many cheap ones.
fn costs(jobs: usize, seed: u64) -> Vec<f64> {
    let mut random = Pcg32::new(seed, 0);
    (0..jobs).map(|_| libm::exp2(-16.0 * f64::from(random.next_u32()) / 4_294_967_296.0)).collect()
}

#[test]
fn no_discipline_beats_the_bounds_and_greedy_ones_keep_grahams() {
    for (name, discipline) in disciplines() {
        for (seed, (jobs, workers)) in [(1, 1), (2, 5), (100, 7), (500, 64), (777, 2)].into_iter().enumerate() {
            let costs = costs(jobs, seed as u64);
            let made = replay(&costs, discipline, workers, &Overhead::default(), &Hardware::default()).makespan_s;
            let workers = if let Discipline::InOrder = discipline { 1 } else { workers };
            let bounds = bounds(&costs, workers);
            assert!(made >= bounds.lower_s * (1.0 - 1e-12), "{name}: {made} below {bounds:?}");
            let kept = made <= bounds.greedy_s * (1.0 + 1e-12);
            assert!(kept || !greedy(discipline, jobs, workers), "{name} on {workers}: {made} above {bounds:?}");
        }
    }
}

/// The number of chunks that one worker takes of jobs of these costs.
fn chunks_of_one(rule: LearnedRule, costs: &[f64]) -> usize {
    let mut ledger = Ledger::new(costs.len(), 1, rule.weights);
    let mut chunks = 0;
    while let Some(chunk) = rule.next(&mut ledger, 0) {
        ledger.note(0, costs[chunk].iter().copied().collect::<Seen>());
        chunks += 1;
    }
    chunks
}

#[test]
fn one_worker_needs_the_sum_and_its_overheads() {
    let overhead = Overhead { run_s: 0.5, start_s: 0.25, job_s: 1e-3, take_s: 2e-3, shared_s: 0.0 };
    let (costs, jobs) = (costs(64, 3), 64.0);
    for (name, discipline) in disciplines() {
        let takes = match discipline {
            Discipline::Chunks(rule) => rule.chunks(costs.len(), 1).count() as f64,
            Discipline::Learned(rule) => chunks_of_one(rule, &costs) as f64,
            // One for each batch from the shared queue.
            Discipline::Stealing(Stealing { start: Start::Shared(_), .. }) => 7.0,
            _ => 0.0,
        };
        let starts = if let Discipline::AllAtOnce = discipline { jobs } else { 1.0 };
        let expected = costs.iter().sum::<f64>() + 0.5 + starts * 0.25 + jobs * 1e-3 + takes * 2e-3;
        let made = replay(&costs, discipline, 1, &overhead, &Hardware::default()).makespan_s;
        assert!((made - expected).abs() < 1e-9, "{name}: {made} instead of {expected}");
    }
}

#[test]
fn work_is_conserved_and_a_worker_does_one_thing_at_a_time() {
    let costs = costs(300, 4);
    let overhead = Overhead { run_s: 0.5, start_s: 0.25, job_s: 1e-3, take_s: 2e-3, shared_s: 1e-3 };
    for (name, discipline) in disciplines() {
        let replayed = replay(&costs, discipline, 16, &overhead, &Hardware::default());
        assert_eq!(replayed, replay(&costs, discipline, 16, &overhead, &Hardware::default()), "{name}");
        assert_eq!(replayed.trace.jobs.len(), costs.len());
        if let Discipline::AllAtOnce = discipline {
            continue;
        }
        let mut spans = replayed.trace.jobs.clone();
        for (span, cost) in spans.iter().zip(&costs) {
            assert!((span.duration_s() - cost).abs() < 1e-9, "{name}: {span:?} for {cost}");
            assert!(span.start_s >= 0.75 && span.stop_s <= replayed.makespan_s, "{name}: {span:?}");
        }
        spans.sort_by(|a, b| a.worker.cmp(&b.worker).then(a.start_s.total_cmp(&b.start_s)));
        let overlap = spans.windows(2).find(|two| two[0].worker == two[1].worker && two[1].start_s < two[0].stop_s);
        assert_eq!(overlap, None, "{name}");
    }
}

#[test]
fn nothing_to_do_takes_no_worker() {
    for (name, discipline) in disciplines() {
        let overhead = Overhead { run_s: 0.5, start_s: 0.25, ..Overhead::default() };
        let replayed = replay(&[], discipline, 4, &overhead, &Hardware::default());
        assert_eq!(replayed.makespan_s, 0.5, "{name}");
        assert!(replayed.trace.jobs.is_empty(), "{name}");
    }
}
