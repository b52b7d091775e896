//! Speedup against `serial`, efficiency, and the serial fraction by which Karp and Flatt explain what is missing.

use crate::analysis::speedup::{Oddity, efficiency, oddity, serial_fraction};
use crate::analysis::Estimate;
use crate::error::Result;
use crate::measure::THREAD_PER_ROW;
use crate::plot::style::Look;
use crate::plot::{Axis, Curve, LineChart, Overlay, Point, Series};
use crate::report::block::{Block, Table};
use crate::report::results::{Results, Schedule};
use std::collections::BTreeMap;

/// More threads than this are no axis any more: a thread for each row is in the table and in the findings.
const MOST_ON_AXIS: usize = 64;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let speedups = results.speedups();
    let processors = results.run.machine.processors;
    let table = Table {
        title: "Speedup against serial, efficiency and Karp-Flatt serial fraction".to_string(),
        columns: [
            "strategy", "pieces", "threads", "speedup", "95 % interval", "efficiency per thread", "efficiency per processor in use",
            "e, p = threads", "e, p = processors in use", "remark",
        ]
        .map(String::from)
        .to_vec(),
        rows: speedups.iter().map(|(schedule, estimate)| row(schedule, estimate, processors)).collect(),
    };
    let mut blocks = vec![
        Block::Figure { stem: "speedup", figure: Box::new(speedup_chart(results, &speedups)) },
        Block::Figure { stem: "efficiency", figure: Box::new(efficiency_chart(results, &speedups)) },
    ];
    blocks.extend(findings(&speedups, processors));
    blocks.push(Block::Table { stem: "karp-flatt", table });
    Ok(blocks)
}

/// Workers that can run at the same time.
fn in_use(threads: usize, processors: usize) -> usize {
    threads.min(processors)
}

fn row(schedule: &Schedule, estimate: &Estimate, processors: usize) -> Vec<String> {
    let (speedup, interval, threads) = (estimate.value, estimate.interval, schedule.threads);
    let used = in_use(threads, processors);
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_string(), |value| format!("{value:.3}"));
    let relative = if threads == 1 { "relative speedup: the strategy's own cost at one worker" } else { "" };
    let remark = match oddity(&interval, used) {
        Some(Oddity::Superlinear) => "superlinear: more than the processors in use",
        Some(Oddity::Slowdown) if threads > 1 => "slower than serial",
        _ => relative,
    };
    vec![
        schedule.strategy.clone(),
        schedule.decomposition.clone(),
        threads.to_string(),
        format!("{speedup:.3}"),
        format!("{:.3} to {:.3}", interval.low, interval.high),
        number(efficiency(speedup, threads)),
        number(efficiency(speedup, used)),
        number(serial_fraction(speedup, threads)),
        number(serial_fraction(speedup, used)),
        remark.to_string(),
    ]
}

/// One series a strategy, and the thread counts that occur.
fn series(speedups: &[(Schedule, Estimate)], value: impl Fn(f64, usize) -> f64) -> (Vec<Series>, Vec<f64>) {
    let mut lines: BTreeMap<&str, Vec<Point>> = BTreeMap::new();
    let mut ticks = Vec::new();
    for (schedule, estimate) in speedups.iter().filter(|(schedule, _)| schedule.threads <= MOST_ON_AXIS) {
        let threads = schedule.threads;
        let interval = (value(estimate.interval.low, threads), value(estimate.interval.high, threads));
        let point = Point::new(threads as f64, value(estimate.value, threads)).with_y(Some(interval));
        lines.entry(&schedule.strategy).or_default().push(point);
        ticks.push(threads as f64);
    }
    ticks.sort_by(f64::total_cmp);
    ticks.dedup();
    let series = lines.into_iter().enumerate().map(|(index, (name, points))| Series::new(name, Look::nth(index), points));
    (series.collect(), ticks)
}

fn speedup_chart(results: &Results, speedups: &[(Schedule, Estimate)]) -> LineChart {
    let (series, ticks) = series(speedups, |speedup, _| speedup);
    let processors = results.run.machine.processors as f64;
    let most = processors.max(1.0) * 1.25;
    let mut chart = LineChart::new(
        "Speedup against threads",
        Axis::log("threads").ticks_at(ticks),
        Axis::linear("speedup against serial").including([0.0, most]),
        series,
    );
    chart.subtitle = results.workload();
    chart.caption = "Median of ratios within a repetition. Bars: 95 % bootstrap interval.".to_string();
    chart.overlays = vec![
        Overlay::guide(format!("{processors} processors"), Curve::Line { intercept: processors, slope: 0.0 }),
        Overlay::guide("ideal: one per thread", Curve::Line { intercept: 0.0, slope: 1.0 }),
    ];
    chart.dodge = 5.0;
    chart
}

fn efficiency_chart(results: &Results, speedups: &[(Schedule, Estimate)]) -> LineChart {
    let processors = results.run.machine.processors;
    let (series, ticks) = series(speedups, |speedup, threads| speedup / in_use(threads, processors) as f64);
    let mut chart = LineChart::new(
        "Efficiency against threads",
        Axis::log("threads").ticks_at(ticks),
        Axis::linear("speedup per processor in use").including([0.5, 1.05]),
        series,
    );
    chart.subtitle = results.workload();
    chart.caption = "Processors in use: the smaller of threads and processors. Bars: 95 % bootstrap interval.".to_string();
    chart.overlays = vec![Overlay::guide("ideal: 1", Curve::Line { intercept: 1.0, slope: 0.0 })];
    chart.dodge = 5.0;
    chart
}

fn findings(speedups: &[(Schedule, Estimate)], processors: usize) -> Vec<Block> {
    let mut findings = Vec::new();
    let at_processors = speedups.iter().filter(|(schedule, _)| schedule.threads == processors && processors > 1);
    if let Some((schedule, estimate)) = at_processors.max_by(|a, b| a.1.value.total_cmp(&b.1.value)) {
        findings.push(Block::Finding(format!(
            "With {processors} threads on {processors} processors the fastest is {} at {:.3} times serial (95 % {:.3} to {:.3}), an \
             efficiency of {:.3}. Strategies whose intervals overlap it are not told apart by this run.",
            schedule.strategy,
            estimate.value,
            estimate.interval.low,
            estimate.interval.high,
            estimate.value / processors as f64,
        )));
    }
    if let Some((schedule, estimate)) = speedups.iter().find(|(schedule, _)| schedule.strategy == THREAD_PER_ROW) {
        findings.push(Block::Finding(format!(
            "A thread for each of {} rows is {:.3} times as fast as serial (95 % {:.3} to {:.3}), not {} times: report A's claim that \
             a thread per row divides the time by the number of rows is refuted here. Threads beyond the {processors} processors only wait.",
            schedule.threads, estimate.value, estimate.interval.low, estimate.interval.high, schedule.threads,
        )));
    }
    findings
}
