//! Scaled speedup: how many times as long the serial program would have taken for the larger problem.

use super::scaling_laws;
use crate::analysis::scaling_law::Law;
use crate::error::Result;
use crate::plot::style::Look;
use crate::plot::{Axis, Curve, LineChart, Overlay, Point, Series};
use crate::report::block::Block;
use crate::report::results::{Results, confidence};
use std::collections::BTreeMap;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let speedups = results.speedups();
    let mut lines: BTreeMap<&str, Vec<Point>> = BTreeMap::new();
    for (schedule, estimate) in &speedups {
        let bar = Some((estimate.interval.low, estimate.interval.high));
        lines
            .entry(&schedule.strategy)
            .or_default()
            .push(Point::new(schedule.threads as f64, estimate.value).with_y(bar));
    }
    let intervals: Vec<_> = speedups.iter().map(|(_, estimate)| estimate.interval).collect();
    let mut ticks: Vec<f64> = speedups.iter().map(|(schedule, _)| schedule.threads as f64).collect();
    ticks.sort_by(f64::total_cmp);
    ticks.dedup();
    let series =
        lines.into_iter().enumerate().map(|(index, (name, points))| Series::new(name, Look::nth(index), points));
    let mut chart = LineChart::new(
        "Weak scaling: scaled speedup against threads",
        Axis::log("threads, each with the same samples per pixel").ticks_at(ticks),
        Axis::linear("serial time for the same samples / time").including([0.0]),
        series.collect(),
    );
    chart.subtitle = results.workload();
    chart.caption = format!("Median of ratios within a repetition. Bars: {}.", confidence(&intervals));
    chart.overlays = vec![Overlay::guide("ideal: one per thread", Curve::Line { intercept: 0.0, slope: 1.0 })];
    chart.dodge = 6.0;
    Ok(vec![
        Block::Figure { stem: "weak-scaling", figure: Box::new(chart) },
        scaling_laws::table(results, &[Law::Gustafson], "gustafson"),
    ])
}
