//! Makespans that can be worked out by hand.

use super::*;
use crate::simulate::{bounds, longest_first};
use crate::strategy::{Amount, ChunkRule, STRATEGIES, Start, Stealing, Victim, find};

const FREE: Overhead = Overhead { run_s: 0.0, start_s: 0.0, job_s: 0.0, take_s: 0.0, shared_s: 0.0 };
const SINGLE: Discipline = Discipline::Chunks(ChunkRule { size: |_| 1, parameter: 1 });
const BLOCKS: Discipline =
    Discipline::Dealt(|worker, workers, jobs| (worker * jobs / workers..(worker + 1) * jobs / workers).step_by(1));
const CYCLIC: Discipline = Discipline::Dealt(|worker, workers, jobs| (worker..jobs).step_by(workers));

fn stealing(start: Start, amount: Amount, victim: Victim) -> Discipline {
    Discipline::Stealing(Stealing { start, amount, victim })
}

fn makespan(costs: &[f64], discipline: Discipline, workers: usize) -> f64 {
    replay(costs, discipline, workers, &FREE, &Hardware::default()).makespan_s
}

#[test]
fn equal_jobs() {
    for (jobs, workers) in [(12, 4), (13, 4), (3, 8), (1000, 7)] {
        let rounds = jobs_div(jobs, workers);
        for discipline in [SINGLE, CYCLIC, stealing(Start::Blocks, Amount::One, Victim::Richest)] {
            assert_eq!(
                makespan(&vec![0.5; jobs], discipline, workers),
                0.5 * rounds,
                "{jobs} on {workers}: {discipline:?}"
            );
        }
    }
    assert_eq!(makespan(&[0.5; 12], BLOCKS, 4), 1.5);
    assert_eq!(makespan(&[0.5; 12], Discipline::Halving, 4), 1.5);
    assert_eq!(makespan(&[0.5; 12], Discipline::InOrder, 4), 6.0);
}

fn jobs_div(jobs: usize, workers: usize) -> f64 {
    jobs.div_ceil(workers) as f64
}

/// The giant comes first, so the other workers finish the rest meanwhile.
#[test]
fn one_giant_job_is_the_makespan() {
    let costs: Vec<f64> = std::iter::once(100.0).chain([1.0; 200]).collect();
    for victim in [Victim::Neighbour, Victim::Random, Victim::Richest] {
        for amount in [Amount::One, Amount::Half] {
            for start in [Start::Blocks, Start::Shared(32)] {
                assert_eq!(
                    makespan(&costs, stealing(start, amount, victim), 4),
                    100.0,
                    "{start:?} {amount:?} {victim:?}"
                );
            }
        }
    }
    assert_eq!(makespan(&costs, SINGLE, 4), 100.0);
    assert_eq!(makespan(&costs, Discipline::Halving, 4), 100.0);
    // The block's other jobs wait for the giant.
    assert_eq!(makespan(&costs, BLOCKS, 3), 100.0 + 66.0);
}

/// P (P - 1) jobs of 1 and then one of P: the list schedule takes 2 P - 1, the best one P (Graham 1966).
#[test]
fn graham_worst_case_of_a_list() {
    for workers in [2, 3, 8, 50] {
        let long = workers as f64;
        let mut costs = vec![1.0; workers * (workers - 1)];
        costs.push(long);
        assert_eq!(makespan(&costs, SINGLE, workers), 2.0 * long - 1.0);
        assert_eq!(bounds(&costs, workers).greedy_s, 2.0 * long - 1.0);
        let sorted: Vec<f64> = longest_first(&costs).into_iter().map(|job| costs[job]).collect();
        assert_eq!(makespan(&sorted, SINGLE, workers), long);
    }
}

/// Two jobs each of 2P - 1 to P + 1 and three of P: the longest first take 4P - 1, the best schedule 3P (Graham 1969).
#[test]
fn graham_worst_case_of_the_longest_first() {
    for workers in [2, 3, 4, 9, 20] {
        let pairs = (workers + 1..2 * workers).rev().flat_map(|cost| [cost, cost]);
        let costs: Vec<f64> = pairs.chain([workers; 3]).map(|cost| cost as f64).collect();
        assert_eq!(costs.len(), 2 * workers + 1);
        assert_eq!(longest_first(&costs), (0..costs.len()).collect::<Vec<_>>());
        assert_eq!(makespan(&costs, SINGLE, workers), 4.0 * workers as f64 - 1.0);
    }
}

/// Costs 1 to n: the last block has the n/p most expensive jobs, every cyclic share has n/p jobs that are p apart.
#[test]
fn a_ramp_in_blocks_and_dealt_like_cards() {
    let (jobs, workers) = (120_usize, 4_usize);
    let costs: Vec<f64> = (1..=jobs).map(|cost| cost as f64).collect();
    let (n, p) = (jobs as f64, workers as f64);
    assert_eq!(makespan(&costs, BLOCKS, workers), n / p * (n + n - n / p + 1.0) / 2.0);
    assert_eq!(makespan(&costs, CYCLIC, workers), n / p * (p + n) / 2.0);
}

/// With equal jobs, every chunk rule ends at most one last chunk after the fair share, or after the longest chunk if
/// that is larger.
#[test]
fn chunk_rules_on_equal_jobs_end_within_the_longest_chunk() {
    for entry in STRATEGIES {
        let Discipline::Chunks(rule) = entry.discipline else { continue };
        for (jobs, workers) in [(1000, 4), (999, 7), (64, 64), (20_000, 96)] {
            let last = rule.chunks(jobs, workers).map(|chunk| chunk.len()).last().unwrap_or_default();
            let share = jobs as f64 / workers as f64;
            let most = share.max(rule.chunks(jobs, workers).map(|chunk| chunk.len()).max().unwrap() as f64);
            let made = makespan(&vec![1.0; jobs], Discipline::Chunks(rule), workers);
            assert!(made <= most + last as f64 && made >= share, "{}: {jobs} on {workers}: {made}", entry.name);
        }
    }
}

#[test]
fn a_shared_place_is_the_bottleneck_of_small_jobs() {
    let overhead = Overhead { take_s: 1e-3, shared_s: 5e-4, ..FREE };
    let on = |workers| replay(&[1e-6; 1000], SINGLE, workers, &overhead, &Hardware::default()).makespan_s;
    // Each job is a chunk: one worker is busy with its hand-outs; many wait for the place, and the last one needs
    // `take` and its job after that.
    assert!((on(1) - 1000.0 * (1e-3 + 1e-6)).abs() < 1e-9);
    let bottleneck = 999.0 * 5e-4 + 1e-3 + 1e-6;
    assert!((on(64) - bottleneck).abs() < 1e-9, "{} instead of {bottleneck}", on(64));
    let batches = stealing(Start::Shared(32), Amount::Half, Victim::Neighbour);
    assert!(replay(&[1e-6; 1000], batches, 64, &overhead, &Hardware::default()).makespan_s >= 1000.0 * 5e-4);
}

#[test]
fn workers_start_one_after_the_other() {
    let overhead = Overhead { run_s: 1.0, start_s: 0.25, job_s: 0.125, ..FREE };
    let replayed = replay(&[2.0; 4], BLOCKS, 4, &overhead, &Hardware::default());
    let starts: Vec<f64> = replayed.trace.jobs.iter().map(|job| job.start_s).collect();
    assert_eq!(starts, [1.375, 1.625, 1.875, 2.125]);
    assert_eq!(replayed.makespan_s, 4.125);
}

#[test]
fn threads_share_the_processors() {
    let all = |costs: &[f64], processors| makespan(costs, Discipline::AllAtOnce, processors);
    assert_eq!(all(&[1.0; 12], 4), 3.0);
    assert_eq!(all(&[1.0; 13], 4), 3.25);
    assert_eq!(all(&[1.0; 3], 4), 1.0);
    // Ten threads share two processors until each has had 1 s, which takes 5 s; then the long one runs alone.
    let costs: Vec<f64> = [1.0; 9].into_iter().chain([7.0]).collect();
    assert!((all(&costs, 2) - (5.0 + 6.0)).abs() < 1e-12);
    // On one processor the caller and the threads take turns, and the processor never idles.
    let overhead = Overhead { start_s: 0.5, ..FREE };
    let one = replay(&[1.0; 5], Discipline::AllAtOnce, 1, &overhead, &Hardware::default());
    assert!((one.makespan_s - 7.5).abs() < 1e-12);
    // On two, the first thread is done when the second one starts.
    let two = replay(&[0.5; 5], Discipline::AllAtOnce, 2, &overhead, &Hardware::default());
    assert!((two.makespan_s - 3.0).abs() < 1e-12);
}

#[test]
fn unequal_processors() {
    let on = |hardware, discipline, workers| replay(&[1.0; 12], discipline, workers, &FREE, &hardware).makespan_s;
    // Dealt jobs wait for the slow processor; with single jobs, free workers take the jobs that it cannot run in time.
    assert_eq!(on(Hardware::OneSlow(0.5), BLOCKS, 4), 6.0);
    assert_eq!(on(Hardware::OneSlow(0.5), SINGLE, 4), 4.0);
    assert_eq!(on(Hardware::Mixed { performance: 2, efficient: 0.5 }, CYCLIC, 4), 6.0);
    assert_eq!(on(Hardware::Mixed { performance: 2, efficient: 0.5 }, SINGLE, 4), 4.0);
    assert_eq!(on(Hardware::Mixed { performance: 2, efficient: 0.5 }, Discipline::AllAtOnce, 4), 4.0);
}

/// 20 000 equal jobs on four workers, the first half as fast: the minimum is 20 000 / 3.5. Rules that learn the speeds,
/// or are given them, come within 1 % of that; blocks take 75 % longer.
#[test]
fn rules_that_know_speeds_share_by_them() {
    let hardware = Hardware::OneSlow(0.5);
    let on = |discipline| replay(&vec![1.0; 20_000], discipline, 4, &FREE, &hardware).makespan_s * 3.5 / 20_000.0;
    assert_eq!(on(BLOCKS), 1.75);
    for (name, parameter) in
        [("weighted-factoring", Some("0.5:1:1:1")), ("awf-b", None), ("awf-c", None), ("adaptive-factoring", None)]
    {
        let share = on(find(name).unwrap().discipline(parameter).unwrap());
        assert!((1.0..1.01).contains(&share), "{name}: {share}");
    }
    // Wrong weights are worse than none.
    let of = |weights| on(find("weighted-factoring").unwrap().discipline(Some(weights)).unwrap());
    assert!(of("4:1:1:1") > 1.2 && of("1") < 1.01, "{} {}", of("4:1:1:1"), of("1"));
}
