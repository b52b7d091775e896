//! Speedup against `serial`, efficiency, and the serial fraction by which Karp and Flatt explain what is missing.

use super::scaling_laws;
use crate::analysis::Estimate;
use crate::analysis::scaling_law::{Check, Fit, Fitted, Law, Point as LawPoint, fit};
use crate::analysis::speedup::{Oddity, efficiency, oddity, serial_fraction_estimate};
use crate::analysis::superlinear::{Evidence, cause};
use crate::error::Result;
use crate::measure::THREAD_PER_ROW;
use crate::plot::dot_plot::{Dot, DotPlot, Group, Row};
use crate::plot::style::Look;
use crate::plot::{Axis, Curve, Figure, LineChart, Overlay, Point, Series};
use crate::report::block::{Block, Table};
use crate::report::results::{LEVEL, Results, Schedule, median_with_interval, with_level};
use crate::strategy::{self, Workers};
use std::collections::{BTreeMap, BTreeSet};

/// Whether the number of threads is the strategy's own rule, so that it is no place on an axis.
fn has_a_thread_per_job(schedule: &Schedule) -> bool {
    let name = schedule.strategy.split(':').next().unwrap_or_default();
    schedule.strategy == THREAD_PER_ROW || strategy::find(name).is_some_and(|entry| entry.workers == Workers::PerJob)
}

/// More lines than this cannot be told apart in one chart: strategies become named rows instead.
const MOST_LINES: usize = 8;

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
            "work inflation",
            "e, p = threads (confidence)",
            "e, p = processors in use (confidence)",
            "remark",
        ]
        .map(String::from)
        .to_vec(),
        rows: speedups.iter().map(|(schedule, estimate)| row(results, schedule, estimate)).collect(),
    };
    let strategies: BTreeSet<&str> = speedups.iter().map(|(schedule, _)| schedule.strategy.as_str()).collect();
    let figures: [(&'static str, Box<dyn Figure>); 2] = if strategies.len() > MOST_LINES {
        let per_processor = |speedup: f64, threads: usize| speedup / in_use(threads, processors) as f64;
        let of_speedup =
            dots(results, &speedups, ["Speedup by strategy", "speedup against serial", "serial"], |speedup, _| speedup);
        let of_efficiency = dots(
            results,
            &speedups,
            ["Efficiency by strategy", "speedup per processor in use", "ideal"],
            per_processor,
        );
        [("speedup", Box::new(of_speedup)), ("efficiency", Box::new(of_efficiency))]
    } else {
        [
            ("speedup", Box::new(speedup_chart(results, &speedups))),
            ("efficiency", Box::new(efficiency_chart(results, &speedups))),
        ]
    };
    let mut blocks: Vec<Block> = figures.into_iter().map(|(stem, figure)| Block::Figure { stem, figure }).collect();
    blocks.extend(findings(results, &speedups));
    blocks.push(Block::Table { stem: "karp-flatt", table });
    Ok(blocks)
}

/// Workers that can run at the same time.
fn in_use(threads: usize, processors: usize) -> usize {
    threads.min(processors)
}

fn row(results: &Results, schedule: &Schedule, estimate: &Estimate) -> Vec<String> {
    let (speedup, interval, threads) = (estimate.value, estimate.interval, schedule.threads);
    let used = in_use(threads, results.run.machine.processors);
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_string(), |value| format!("{value:.3}"));
    let speedups = results.paired_speedups(schedule);
    let fraction = |workers: usize| {
        serial_fraction_estimate(&speedups, workers, LEVEL).map_or_else(
            || "-".to_string(),
            |e| format!("{:.3}, {}", e.value, with_level(&e.interval, 3)),
        )
    };
    let remark = match oddity(&interval, used) {
        Some(Oddity::Superlinear) => format!("superlinear; {}", cause(&evidence(results, schedule))),
        Some(Oddity::Slowdown) if threads > 1 => "slower than serial".to_string(),
        _ if threads == 1 => "relative speedup: the strategy's own cost at one worker".to_string(),
        _ => String::new(),
    };
    vec![
        schedule.strategy.clone(),
        schedule.decomposition.clone(),
        threads.to_string(),
        format!("{speedup:.3}"),
        with_level(&interval, 3),
        number(efficiency(speedup, threads)),
        number(efficiency(speedup, used)),
        number(results.work_inflation(schedule)),
        fraction(threads),
        fraction(used),
        remark,
    ]
}

/// What is known beside a speedup that is too good.
fn evidence(results: &Results, schedule: &Schedule) -> Evidence {
    let alone = Schedule { threads: 1, ..schedule.clone() };
    let doubts = ["foreign-load", "drift", "slowed", "too-short"];
    // The baseline's doubts count as well: a serial run that was held up makes all others look fast.
    let concerned =
        |own: &Schedule| own == schedule || (own.strategy == "serial" && own.decomposition == schedule.decomposition);
    let warned = |record: &&crate::measure::Record| {
        concerned(&Schedule::of(record)) && doubts.iter().any(|doubt| record.warnings.contains(doubt))
    };
    let machine = &results.run.machine;
    Evidence {
        at_one_worker: (schedule.threads > 1)
            .then(|| median_with_interval(&results.paired_speedups(&alone)).and_then(|(_, interval)| interval))
            .flatten(),
        warnings: results.records.iter().filter(warned).count(),
        processors: Some(machine.processors),
        physical_cores: Some(machine.physical_cores).filter(|cores| *cores > 0),
    }
}

/// A row for each strategy, a dot for each number of threads; strategies with a rule of their own have a single dot.
fn dots(
    results: &Results,
    speedups: &[(Schedule, Estimate)],
    [title, axis, guide]: [&str; 3],
    value: impl Fn(f64, usize) -> f64,
) -> DotPlot {
    let mut threads: Vec<usize> =
        speedups.iter().filter(|(s, _)| !has_a_thread_per_job(s)).map(|(s, _)| s.threads).collect();
    threads.sort_unstable();
    threads.dedup();
    let several = speedups.iter().map(|(s, _)| &s.decomposition).collect::<BTreeSet<_>>().len() > 2;
    let mut rows: BTreeMap<String, Vec<Option<Dot>>> = BTreeMap::new();
    for (schedule, estimate) in speedups {
        // One decomposition, and the rows of report A beside it, need no name.
        let name = if several {
            format!("{}, {}", schedule.strategy, schedule.decomposition)
        } else {
            schedule.strategy.clone()
        };
        let dots = rows.entry(name).or_insert_with(|| vec![None; threads.len() + 1]);
        let place = threads.iter().position(|threads| *threads == schedule.threads);
        let group = place.filter(|_| !has_a_thread_per_job(schedule)).unwrap_or(threads.len());
        let of = |speedup: f64| value(speedup, schedule.threads);
        let interval = Some((of(estimate.interval.low), of(estimate.interval.high)));
        dots[group] = Some(Dot { value: of(estimate.value), interval });
    }
    let mut rows: Vec<Row> = rows.into_iter().map(|(name, dots)| Row { name, dots }).collect();
    let best = |row: &Row| row.dots.iter().flatten().map(|dot| dot.value).fold(0.0, f64::max);
    rows.sort_by(|a, b| best(b).total_cmp(&best(a)));
    let mut names: Vec<String> = threads
        .iter()
        .map(|threads| if *threads == 1 { "1 thread".into() } else { format!("{threads} threads") })
        .collect();
    if rows.iter().any(|row| row.dots[threads.len()].is_some()) {
        names.push("a thread per job".to_string());
    } else {
        for row in &mut rows {
            row.dots.truncate(threads.len());
        }
    }
    let mut plot = DotPlot::new(title, Axis::linear(axis).including([0.9]), rows);
    plot.groups = names.into_iter().enumerate().map(|(index, name)| Group { name, look: Look::nth(index) }).collect();
    plot.guides = vec![(1.0, guide.to_string())];
    plot.subtitle = results.workload();
    plot.caption = "Median of ratios within a repetition. Bars: distribution-free interval.".to_string();
    plot
}

/// One series a strategy, and the thread counts that occur.
fn series(speedups: &[(Schedule, Estimate)], value: impl Fn(f64, usize) -> f64) -> (Vec<Series>, Vec<f64>) {
    let mut lines: BTreeMap<&str, Vec<Point>> = BTreeMap::new();
    let mut ticks = Vec::new();
    for (schedule, estimate) in speedups.iter().filter(|(schedule, _)| !has_a_thread_per_job(schedule)) {
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
    for (schedule, estimate) in speedups.iter().filter(|(schedule, _)| has_a_thread_per_job(schedule)) {
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
    chart.overlays.extend(fits(results, &chart.series));
    chart.dodge = 5.0;
    chart
}

/// Amdahl's law where the points bear it out, in the colours of the strategies' lines.
fn fits(results: &Results, series: &[Series]) -> Vec<Overlay> {
    let overlay = |(name, points): (String, Vec<LawPoint>)| {
        let Fit::Found(Fitted { parameters, check: Check::Passed { .. }, .. }) = fit(Law::Amdahl, &points, LEVEL)
        else {
            return None;
        };
        let serial_share = parameters.first()?.estimate.value;
        let curve = Curve::Scaling { contention: serial_share, coherence: 0.0 };
        let line = series.iter().position(|series| series.name == name)?;
        Some(Overlay::fit(format!("{name}: Amdahl, s = {serial_share:.3}"), curve, line))
    };
    scaling_laws::points(results).into_iter().filter_map(overlay).collect()
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
