//! Seconds against samples per pixel: a line through the origin, if nothing but sampling takes time.

use crate::analysis::Interval;
use crate::analysis::fit::{line, log_log};
use crate::error::Result;
use crate::measure::Record;
use crate::plot::style::Look;
use crate::plot::{Axis, Curve, LineChart, Overlay, Point, Series};
use crate::report::block::Block;
use crate::report::results::{LEVEL, Results, Schedule, confidence, median_with_interval};
use std::collections::BTreeMap;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let mut lines: BTreeMap<String, Vec<Point>> = BTreeMap::new();
    let mut intervals = Vec::new();
    for ((name, spp), records) in results.by(|record| (image_and_schedule(results, record), record.spp)) {
        let times: Vec<f64> = records.iter().filter_map(|record| record.makespan_s).collect();
        if let Some((median, interval)) = median_with_interval(&times) {
            intervals.push(interval);
            let bar = interval.map(|interval| (interval.low, interval.high));
            lines.entry(name).or_default().push(Point::new(f64::from(spp), median).with_y(bar));
        }
    }
    let intervals: Vec<Interval> = intervals.into_iter().flatten().collect();
    let (mut overlays, mut findings, mut series) = (Vec::new(), Vec::new(), Vec::new());
    for (index, (name, points)) in lines.into_iter().enumerate() {
        let pairs: Vec<(f64, f64)> = points.iter().map(|point| (point.x, point.y)).collect();
        if let (Some(fit), Some(power)) = (line(&pairs, LEVEL), log_log(&pairs, LEVEL)) {
            let (slope, interval) = (fit.slope.value, fit.slope.interval);
            overlays.push(Overlay::fit(
                format!("fit: {:.2} ms per spp", slope * 1e3),
                Curve::Line { intercept: fit.intercept.value, slope },
                index,
            ));
            let exponent = power.slope.interval;
            let verdict = if exponent.contains(1.0) {
                "the interval contains 1: no departure from linear is seen"
            } else {
                "the interval does not contain 1"
            };
            findings.push(Block::Finding(format!(
                "{name}: {:.3} ms per sample per pixel (95 % {:.3} to {:.3}) and {:.1} ms besides ({:.1} to {:.1}); the exponent of time \
                 against spp is {:.3} (95 % {:.3} to {:.3}); {verdict}.",
                slope * 1e3,
                interval.low * 1e3,
                interval.high * 1e3,
                fit.intercept.value * 1e3,
                fit.intercept.interval.low * 1e3,
                fit.intercept.interval.high * 1e3,
                power.slope.value,
                exponent.low,
                exponent.high,
            )));
        }
        series.push(Series::new(name, Look::nth(index), points).scattered());
    }
    let ticks: Vec<f64> = results.by(|record| record.spp).into_keys().map(f64::from).collect();
    let mut chart = LineChart::new(
        "Time against samples per pixel",
        Axis::linear("samples per pixel").ticks_at(ticks).including([0.0]),
        Axis::linear("wall seconds").including([0.0]),
        series,
    );
    chart.subtitle = results.workload();
    chart.caption = format!("Points: median over seeds and repetitions. Bars: {}.", confidence(&intervals));
    chart.overlays = overlays;
    let mut blocks = vec![Block::Figure { stem: "time-against-spp", figure: Box::new(chart) }];
    blocks.extend(findings);
    Ok(blocks)
}

/// The estimator, what else differs among the images, and the schedule where there are several: times of different schedules are not to be
/// thrown together.
fn image_and_schedule(results: &Results, record: &Record) -> String {
    let series = results.series_name(record);
    let image = if series.is_empty() { record.estimator.clone() } else { series };
    if results.by(Schedule::of).len() == 1 { image } else { format!("{image}, {}", Schedule::of(record).label()) }
}
