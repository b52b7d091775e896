//! A against A: odd and even repetitions of the same cell, compared as other experiments compare different cells.

use crate::analysis::aa_test::{Comparison, calibration};
use crate::prelude::*;

/// Pairs in a comparison: the smallest number whose interval of the median reaches 95 %.
const PAIRS: usize = 6;
/// Significance level for the number of misses.
const ALPHA: f64 = 0.01;

/// The median ratios of one cell's comparisons. Two successive repetitions form a pair, `PAIRS` successive pairs a
/// comparison.
fn compared(rows: &[&Row]) -> Vec<Estimated> {
    let mut timed: Vec<(u32, f64)> = rows.iter().filter_map(|row| Some((row.repetition, row.makespan_s?))).collect();
    timed.sort_by_key(|(repetition, _)| *repetition);
    let ratios: Vec<f64> = timed.chunks_exact(2).map(|pair| pair[0].1 / pair[1].1).collect();
    ratios.chunks_exact(PAIRS).filter_map(|pairs| Estimated::typical(pairs, Stopping::Fixed)).collect()
}

/// Whether the interval contains 1, the true ratio.
fn comparison(told: &Estimated) -> Option<Comparison> {
    told.interval.map(|interval| Comparison { level: interval.level, contains_truth: interval.contains(1.0) })
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let groups = results.by(|row| (&row.schedule, &row.image)).into_iter();
    let name = |schedule: &Schedule, rows: &[&Row]| joined([results.series_name(rows[0]), schedule.label()]);
    let cells: Vec<(String, Vec<Estimated>)> = groups.map(|((s, _), rows)| (name(s, &rows), compared(&rows))).collect();
    let all: Vec<Comparison> = cells.iter().flat_map(|(_, compared)| compared).filter_map(comparison).collect();
    let misses = |compared: &[Estimated]| compared.iter().filter_map(comparison).filter(|c| !c.contains_truth).count();
    let worst = |compared: &[Estimated]| compared.iter().map(|told| (told.value - 1.0).abs()).fold(0.0, f64::max);
    let finding = calibration(&all, ALPHA).map(|found| {
        Block::finding(format!(
            "Of {} comparisons of a cell with itself {} claim a difference, where the intervals' own confidence lets {:.1} be expected: {} (two-sided \
             p = {:.2}, judged at {ALPHA}).",
            found.comparisons, found.found, found.expected, found.verdict, found.p_value,
        ))
    });
    let table = Block::table("self-test", "A against A", &cells)
        .column("cell", |(label, _)| label.clone())
        .column("comparisons with itself", |(_, compared)| compared.len().to_string())
        .column("claimed differences", |(_, compared)| misses(compared).to_string())
        .column("largest difference of a median ratio from 1", |(_, compared)| {
            format!("{:.2} %", 100.0 * worst(compared))
        })
        .end();
    Ok(finding.into_iter().chain([table]).collect())
}
