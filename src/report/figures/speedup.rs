//! Speedup against `serial`, efficiency, and the serial fraction by which Karp and Flatt explain what is missing.

use crate::analysis::Estimate;
use crate::analysis::speedup::{Oddity, efficiency, oddity, serial_fraction};
use crate::error::Result;
use crate::measure::THREAD_PER_ROW;
use crate::plot::style::Look;
use crate::plot::{Axis, Curve, LineChart, Overlay, Point, Series};
use crate::report::block::{Block, Table};
use crate::report::results::{Results, Schedule, with_level};
use std::collections::BTreeMap;

/// More threads than this are no axis any more: strategies that start so many by a rule of their own become level lines.
const MOST_ON_AXIS: usize = 16;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let speedups = results.speedups();
    let processors = results.run.machine.processors;
    let table = Table {
        title: "Speedup against serial, efficiency and Karp-Flatt serial fraction".to_string(),
        columns: [
            "strategy",
            "pieces",
            "threads",
            "speedup",
            "interval (confidence)",
            "efficiency per thread",
            "efficiency per processor in use",
            "e, p = threads",
            "e, p = processors in use",
            "remark",
        ]
        .map(String::from)
        .to_vec(),
        rows: speedups.iter().map(|(schedule, estimate)| row(schedule, estimate, processors)).collect(),
    };
    let mut blocks = vec![
        Block::Figure { stem: "speedup", figure: Box::new(speedup_chart(results, &speedups)) },
        Block::Figure { stem: "efficiency", figure: Box::new(efficiency_chart(results, &speedups)) },
    ];
    blocks.extend(findings(results, &speedups));
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
        with_level(&interval, 3),
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
    let series =
        lines.into_iter().enumerate().map(|(index, (name, points))| Series::new(name, Look::nth(index), points));
    (series.collect(), ticks)
}

fn speedup_chart(results: &Results, speedups: &[(Schedule, Estimate)]) -> LineChart {
    let (mut series, ticks) = series(speedups, |speedup, _| speedup);
    for (schedule, estimate) in speedups.iter().filter(|(schedule, _)| schedule.threads > MOST_ON_AXIS) {
        let interval = (estimate.interval.low, estimate.interval.high);
        let points = ticks.iter().map(|x| Point::new(*x, estimate.value).with_y(Some(interval))).collect();
        let name = format!("{}: always {}", schedule.strategy, schedule.threads);
        series.push(Series::new(name, Look::nth(series.len()), points));
    }
    let processors = results.run.machine.processors as f64;
    let most = processors.max(1.0) * 1.25;
    let mut chart = LineChart::new(
        "Speedup against threads",
        Axis::log("threads").ticks_at(ticks),
        Axis::linear("speedup against serial").including([0.0, most]),
        series,
    );
    chart.subtitle = results.workload();
    chart.caption = "Median of ratios within a repetition. Bars: distribution-free interval. Level: a thread for each job, whatever is asked for.".to_string();
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
    chart.caption =
        "Processors in use: the smaller of threads and processors. Bars: distribution-free interval of the median."
            .to_string();
    chart.overlays = vec![Overlay::guide("ideal: 1", Curve::Line { intercept: 1.0, slope: 0.0 })];
    chart.dodge = 5.0;
    chart
}

fn findings(results: &Results, speedups: &[(Schedule, Estimate)]) -> Vec<Block> {
    let processors = results.run.machine.processors;
    let mut findings = Vec::new();
    let candidates: Vec<&(Schedule, Estimate)> =
        speedups.iter().filter(|(schedule, _)| schedule.threads == processors && processors > 1).collect();
    if let Some((best, estimate)) = candidates.iter().max_by(|a, b| a.1.value.total_cmp(&b.1.value)) {
        let (mut slower, mut open) = (Vec::new(), Vec::new());
        for (other, _) in candidates.iter().filter(|(other, _)| other != best) {
            if let Some(ratio) = results.time_ratio(other, best) {
                let text = format!("{} ({:.3}, {})", other.strategy, ratio.value, with_level(&ratio.interval, 3));
                if ratio.interval.low > 1.0 { slower.push(text) } else { open.push(text) }
            }
        }
        let list = |names: Vec<String>| if names.is_empty() { "none".to_string() } else { names.join("; ") };
        findings.push(Block::Finding(format!(
            "With {processors} threads on {processors} processors the highest median speedup is that of {}: {:.3} times serial, {}, an \
             efficiency of {:.3}. Paired with it, these take longer (ratio of times, interval): {}. These are not told apart from it by this run: {}.",
            best.strategy,
            estimate.value,
            with_level(&estimate.interval, 3),
            estimate.value / processors as f64,
            list(slower),
            list(open),
        )));
    }
    if let Some((schedule, estimate)) = speedups.iter().find(|(schedule, _)| schedule.strategy == THREAD_PER_ROW) {
        let rows = schedule.threads;
        let verdict = if estimate.interval.high < rows as f64 { "is refuted" } else { "is not refuted" };
        findings.push(Block::Finding(format!(
            "A thread for each of {rows} rows is {:.3} times as fast as serial, {}. Report A's claim that a thread per row divides the time by \
             the number of rows {verdict} by this run.",
            estimate.value,
            with_level(&estimate.interval, 3),
        )));
    }
    findings
}
