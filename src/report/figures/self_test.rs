//! A against A: the same cell in odd and in even repetitions, compared as the other experiments compare different cells.

use crate::analysis::aa_test::{Comparison, calibration};
use crate::analysis::quantile::{median, median_interval};
use crate::error::Result;
use crate::measure::Record;
use crate::report::block::{Block, Table};
use crate::report::results::{LEVEL, Results, Schedule};

/// Pairs in a comparison: the fewest whose interval of the median reaches 95 %.
const PAIRS: usize = 6;
/// Significance at which the number of misses is judged.
const ALPHA: f64 = 0.01;

/// A comparison: the median ratio, and whether its interval holds 1.
struct Compared {
    ratio: f64,
    comparison: Comparison,
}

fn compare(ratios: &[f64]) -> Option<Compared> {
    let interval = median_interval(ratios, LEVEL)?;
    let comparison = Comparison { level: interval.level, contains_truth: interval.contains(1.0) };
    Some(Compared { ratio: median(ratios)?, comparison })
}

/// The comparisons of one cell: successive repetitions are a pair, successive pairs a comparison.
fn comparisons(records: &[&Record]) -> Vec<Compared> {
    let mut timed: Vec<(u32, f64)> = records.iter().filter_map(|r| Some((r.repetition, r.makespan_s?))).collect();
    timed.sort_by_key(|(repetition, _)| *repetition);
    let ratios: Vec<f64> = timed.chunks_exact(2).map(|pair| pair[0].1 / pair[1].1).collect();
    ratios.chunks_exact(PAIRS).filter_map(compare).collect()
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let mut all = Vec::new();
    let mut rows = Vec::new();
    for (schedule, records) in results.by(Schedule::of) {
        let compared = comparisons(&records);
        let misses = compared.iter().filter(|c| !c.comparison.contains_truth).count();
        let worst = compared.iter().map(|c| (c.ratio - 1.0).abs()).fold(0.0, f64::max);
        rows.push(vec![
            schedule.label(),
            compared.len().to_string(),
            misses.to_string(),
            format!("{:.2} %", 100.0 * worst),
        ]);
        all.extend(compared.into_iter().map(|c| c.comparison));
    }
    let columns =
        ["cell", "comparisons with itself", "claimed differences", "largest difference of a median ratio from 1"];
    let title = "A against A".to_string();
    let table = Table { title, columns: columns.map(String::from).to_vec(), rows };
    let mut blocks = Vec::new();
    if let Some(found) = calibration(&all, ALPHA) {
        blocks.push(Block::Finding(format!(
            "Of {} comparisons of a cell with itself {} claim a difference, where the intervals' own confidence lets {:.1} be expected: {} (two-sided \
             p = {:.2}, judged at {ALPHA}).",
            found.comparisons, found.found, found.expected, found.verdict, found.p_value,
        )));
    }
    blocks.push(Block::Table { stem: "self-test", table });
    Ok(blocks)
}
