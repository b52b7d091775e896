//! Films cut into pieces and jobs handed out to workers: each sample and each job exactly once.

use super::cases;
use pathmark::film::{DECOMPOSITIONS, Decomposition, Plan, SAMPLE_BLOCK, sections};
use pathmark::strategy::{Discipline, Ledger, STRATEGIES, Seen, block};
use proptest::prelude::*;

/// Texts for every line of the table, with random numbers as parameters where a line has any.
fn decomposition() -> impl Strategy<Value = String> {
    let orders = prop::sample::select(&["", ":scanline", ":hilbert", ":spiral", ":cost"]);
    let numbers = (1..90_u32, 1..40_u32, 1..40_u32, 0..4_u32, orders);
    (0..DECOMPOSITIONS.len(), numbers).prop_map(|(line, (n, width, height, k, order))| {
        match DECOMPOSITIONS[line].name {
            name @ ("bands" | "grid") => format!("{name}:{n}"),
            "tiles" => format!("tiles:{width}x{height}{order}"),
            "samples" => format!("samples:{}:{width}x{height}", SAMPLE_BLOCK << k),
            _ => DECOMPOSITIONS[line].example.to_string(),
        }
    })
}

/// The problem of a plan, if any: each sample of each pixel must be in exactly one piece.
fn problem(plan: &Plan, width: u32, height: u32, samples: u32) -> Option<String> {
    let mut covered = vec![Vec::new(); width as usize * height as usize];
    for piece in plan.pieces() {
        let bounds = piece.bounds;
        if bounds.x1 > width || bounds.y1 > height || bounds.area() == 0 || piece.samples.is_empty() {
            return Some(format!("{piece:?} is not in the film"));
        }
        for y in bounds.y0..bounds.y1 {
            for x in bounds.x0..bounds.x1 {
                covered[(y * width + x) as usize].push(piece.samples.clone());
            }
        }
    }
    for (pixel, ranges) in covered.iter_mut().enumerate() {
        ranges.sort_by_key(|range| range.start);
        let ends = [0].into_iter().chain(ranges.iter().map(|range| range.end));
        let starts = ranges.iter().map(|range| range.start).chain([samples]);
        if !ends.eq(starts) {
            return Some(format!("pixel {pixel} has the samples {ranges:?} of {samples}"));
        }
    }
    None
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn every_sample_of_every_pixel_is_in_one_piece(
        text in decomposition(), width in 1..70_u32, height in 1..70_u32, samples in 1..200_u32, costs in any::<u64>(),
    ) {
        let decomposition = Decomposition::parse(&text).expect("a line of the table");
        prop_assert_eq!(decomposition.name(), &text);
        let plan = decomposition.plan(width, height, &(0..samples));
        prop_assert_eq!(problem(&plan, width, height, samples), None, "{}", text);
        // For any costs, the most expensive pieces come first, and none is lost.
        let cost = |k: usize| (costs.rotate_left(k as u32) % 7) as f64;
        let costs: Vec<f64> = (0..plan.len()).map(cost).collect();
        let sorted = plan.clone().longest_first(&costs);
        prop_assert_eq!(problem(&sorted, width, height, samples), None, "{}", text);
        let place = |piece| plan.pieces().iter().position(|other| other == piece).expect("a piece of the plan");
        let order: Vec<usize> = sorted.pieces().iter().map(place).collect();
        let right = |pair: &[usize]| costs[pair[0]] > costs[pair[1]] || (costs[pair[0]] == costs[pair[1]] && pair[0] < pair[1]);
        prop_assert!(order.windows(2).all(right), "{order:?}");
    }

    #[test]
    fn sections_follow_one_another(start in 0..1000_u32, length in 0..100_000_u32) {
        let samples = start * SAMPLE_BLOCK..start * SAMPLE_BLOCK + length;
        let found = sections(&samples);
        let ends = [samples.start].into_iter().chain(found.iter().map(|section| section.end));
        prop_assert!(ends.eq(found.iter().map(|section| section.start).chain([samples.end])), "{found:?}");
        // A range of samples has at most two slopes of subtrees, up and down.
        prop_assert!(found.len() <= 2 * 32);
    }

    /// The announced discipline of each strategy hands out every job once.
    #[test]
    fn disciplines_hand_out_every_job_once(jobs in 0..3000_usize, workers in 1..70_usize) {
        for entry in STRATEGIES {
            match entry.discipline {
                Discipline::Dealt(deal) => {
                    let mut dealt: Vec<usize> = (0..workers).flat_map(|worker| deal(worker, workers, jobs)).collect();
                    dealt.sort_unstable();
                    prop_assert!(dealt.into_iter().eq(0..jobs), "{}", entry.name);
                }
                Discipline::Chunks(rule) => {
                    prop_assert!(rule.chunks(jobs, workers).all(|chunk| !chunk.is_empty()), "{}", entry.name);
                    let handed: Vec<usize> = rule.chunks(jobs, workers).flatten().collect();
                    prop_assert!(handed.into_iter().eq(0..jobs), "{}", entry.name);
                }
                Discipline::Learned(rule) => {
                    // Each worker in turn reports a different speed.
                    let (mut ledger, mut handed) = (Ledger::new(jobs, workers, rule.weights), Vec::new());
                    for worker in (0..workers).cycle() {
                        let Some(chunk) = rule.next(&mut ledger, worker) else { break };
                        let seconds = chunk.clone().map(|job| (worker + 1 + job % 3) as f64);
                        ledger.note(worker, seconds.collect::<Seen>());
                        handed.extend(chunk);
                    }
                    prop_assert!(handed.into_iter().eq(0..jobs), "{}", entry.name);
                }
                _ => {}
            }
        }
        let blocks: Vec<usize> = (0..workers).flat_map(|worker| block(worker, workers, jobs)).collect();
        prop_assert!(blocks.into_iter().eq(0..jobs));
    }
}
