//! Each strategy against OpenMP's dynamic schedule, the field's yardstick.

use crate::analysis::Estimate;
use crate::error::Result;
use crate::plot::Axis;
use crate::plot::dot_plot::{Dot, DotPlot, Row};
use crate::report::block::Block;
use crate::report::results::{Results, Schedule, confidence, with_level};

const YARDSTICK: &str = "openmp-dynamic";

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let schedules: Vec<Schedule> = results.by(Schedule::of).into_keys().collect();
    let Some(yardstick) = schedules.iter().find(|schedule| schedule.strategy == YARDSTICK) else {
        return Ok(vec![Block::Finding(format!("{YARDSTICK} was not run, so there is nothing to compare with."))]);
    };
    let others = schedules.iter().filter(|schedule| *schedule != yardstick && schedule.threads == yardstick.threads);
    let mut ratios: Vec<(&Schedule, Estimate)> =
        others.filter_map(|schedule| Some((schedule, results.time_ratio(schedule, yardstick)?))).collect();
    ratios.sort_by(|a, b| a.1.value.total_cmp(&b.1.value));
    let row = |(schedule, ratio): &(&Schedule, Estimate)| Row {
        name: schedule.strategy.clone(),
        dots: vec![Some(Dot { value: ratio.value, interval: Some((ratio.interval.low, ratio.interval.high)) })],
    };
    let axis = Axis::linear(format!("time / time of {YARDSTICK}")).including([0.95, 1.05]);
    let mut plot = DotPlot::new("Time against OpenMP's dynamic schedule", axis, ratios.iter().map(row).collect());
    plot.guides = vec![(1.0, YARDSTICK.to_string())];
    plot.subtitle = results.workload();
    let intervals: Vec<_> = ratios.iter().map(|(_, ratio)| ratio.interval).collect();
    plot.caption = format!("Median of ratios within a repetition. Bars: {}.", confidence(&intervals));
    let mut blocks = vec![Block::Figure { stem: "openmp", figure: Box::new(plot) }];
    if let Some((best, ratio)) = ratios.iter().find(|(schedule, _)| !schedule.strategy.starts_with("openmp")) {
        blocks.push(Block::Finding(format!(
            "With {} threads the fastest of this program's strategies is {}: {:.3} times the time of {YARDSTICK}, {}.",
            best.threads,
            best.strategy,
            ratio.value,
            with_level(&ratio.interval, 3),
        )));
    }
    Ok(blocks)
}
