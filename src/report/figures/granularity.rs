//! Efficiency against the size of a job, the size at which half is lost (METG), and what handing out a job costs.

use crate::analysis::metg::{Grain, HALF, Metg, metg};
use crate::analysis::quantile::median;
use crate::error::Result;
use crate::measure::Record;
use crate::plot::dot_plot::{Dot, DotPlot, Row};
use crate::plot::style::Look;
use crate::plot::{Axis, Curve, LineChart, Overlay, Point, Series};
use crate::report::block::{Block, Table};
use crate::report::results::{LEVEL, Results, Schedule, confidence, median_with_interval};
use std::collections::BTreeMap;

/// The serial program, in seconds: a job by decomposition, the fastest run by repetition, the work by decomposition and repetition.
struct Baseline {
    per_job: BTreeMap<String, f64>,
    best: BTreeMap<u32, f64>,
    work: BTreeMap<(String, u32), f64>,
}

impl Baseline {
    fn of(results: &Results) -> Self {
        let serial: Vec<&Record> = results.records.iter().filter(|record| record.strategy == "serial").collect();
        let mut jobs: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        let (mut bests, mut work) = (BTreeMap::new(), BTreeMap::new());
        for record in serial {
            let Some((busy_s, makespan_s)) = record.busy_sum_s.zip(record.makespan_s) else { continue };
            jobs.entry(record.decomposition.clone()).or_default().push(busy_s / record.jobs as f64);
            work.insert((record.decomposition.clone(), record.repetition), busy_s);
            let best: &mut f64 = bests.entry(record.repetition).or_insert(makespan_s);
            *best = best.min(makespan_s);
        }
        let per_job = jobs.into_iter().filter_map(|(name, times)| Some((name, median(&times)?))).collect();
        Self { per_job, best: bests, work }
    }
}

/// Workers that can run at the same time.
fn in_use(record: &Record, processors: usize) -> f64 {
    record.threads.min(processors).max(1) as f64
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let processors = results.run.machine.processors;
    let baseline = Baseline::of(results);
    let efficiency = |record: &Record| {
        Some(baseline.best.get(&record.repetition)? / (in_use(record, processors) * record.makespan_s?))
    };
    let mut grains: BTreeMap<String, Vec<Grain>> = BTreeMap::new();
    for (schedule, records) in results.by(Schedule::of) {
        let Some(job_s) = baseline.per_job.get(&schedule.decomposition) else { continue };
        let values: Vec<f64> = records.iter().filter_map(|record| efficiency(record)).collect();
        grains.entry(schedule.strategy).or_default().push((*job_s, values));
    }
    let (mut series, mut intervals) = (Vec::new(), Vec::new());
    for (index, (strategy, grains)) in grains.iter_mut().enumerate() {
        grains.sort_by(|a, b| a.0.total_cmp(&b.0));
        let points = grains.iter().filter_map(|(job_s, values)| {
            let (value, interval) = median_with_interval(values)?;
            intervals.extend(interval);
            Some(Point::new(job_s * 1e6, value).with_y(interval.map(|interval| (interval.low, interval.high))))
        });
        series.push(Series::new(strategy.as_str(), Look::nth(index), points.collect()));
    }
    let mut chart = LineChart::new(
        "Efficiency against the size of a job",
        Axis::log("microseconds of work per job (serial)"),
        Axis::linear("best serial time / (processors in use × time)").including([0.0, 1.0]),
        series,
    );
    chart.subtitle = results.workload();
    chart.caption = format!("Bars: {}.", confidence(&intervals));
    chart.overlays = vec![Overlay::guide("one half: METG(50 %)", Curve::Line { intercept: HALF, slope: 0.0 })];
    let mut blocks = vec![Block::Figure { stem: "granularity", figure: Box::new(chart) }, metg_table(&grains)];
    blocks.extend(overhead(results, &baseline, processors));
    Ok(blocks)
}

fn microseconds(seconds: f64) -> String {
    format!("{:.3}", seconds * 1e6)
}

fn metg_table(grains: &BTreeMap<String, Vec<Grain>>) -> Block {
    let row = |(strategy, grains): (&String, &Vec<Grain>)| {
        let (value, remark) = match metg(grains, HALF, LEVEL) {
            Metg::Value { seconds, interval, between, crossings } => {
                let bracket = format!("between {} and {}", microseconds(between.0), microseconds(between.1));
                let interval = interval.map_or_else(String::new, |interval| {
                    let (low, high) = (microseconds(interval.low), microseconds(interval.high));
                    format!("; {low} to {high} ({:.0} %)", 100.0 * interval.level)
                });
                let often = if crossings > 1 { format!("; crosses one half {crossings} times") } else { String::new() };
                (microseconds(seconds), format!("{bracket}{interval}{often}"))
            }
            Metg::Below(least) => {
                (format!("< {}", microseconds(least)), "even the smallest jobs keep half".to_string())
            }
            Metg::Above(most) => (format!("> {}", microseconds(most)), "even the largest jobs do not".to_string()),
            Metg::Undefined(reason) => ("-".to_string(), reason.to_string()),
        };
        vec![strategy.clone(), value, remark]
    };
    let columns = ["strategy", "METG(50 %), microseconds", "how sure"].map(String::from).to_vec();
    let title = "Smallest job that keeps half of the processors".to_string();
    Block::Table { stem: "metg", table: Table { title, columns, rows: grains.iter().map(row).collect() } }
}

/// Processor seconds that a run took beyond the serial work on the same pieces, for each of its jobs, where jobs are smallest.
fn overhead(results: &Results, baseline: &Baseline, processors: usize) -> Option<Block> {
    let extra_ns = |record: &Record| {
        let work_s = baseline.work.get(&(record.decomposition.clone(), record.repetition))?;
        let spent_s = in_use(record, processors) * record.makespan_s?;
        Some((spent_s - work_s) / record.jobs as f64 * 1e9)
    };
    let mut rows = Vec::new();
    let mut intervals = Vec::new();
    for (strategy, records) in results.by(|record| record.strategy.clone()) {
        let most = records.iter().map(|record| record.jobs).max()?;
        let smallest = records.iter().filter(|record| record.jobs == most);
        let values: Vec<f64> = smallest.filter_map(|record| extra_ns(record)).collect();
        let Some((value, interval)) = median_with_interval(&values) else { continue };
        intervals.extend(interval);
        let dot = Dot { value, interval: interval.map(|interval| (interval.low, interval.high)) };
        rows.push(Row { name: format!("{strategy} ({most} jobs)"), dots: vec![Some(dot)] });
    }
    rows.sort_by(|a, b| {
        let value = |row: &Row| row.dots[0].map_or(0.0, |dot| dot.value);
        value(a).total_cmp(&value(b))
    });
    let mut plot = DotPlot::new("What a job costs beside its work", Axis::log("nanoseconds per job"), rows);
    plot.subtitle = results.workload();
    plot.caption = format!(
        "(Processors in use × time - serial work on the same pieces) / jobs, at the most jobs measured; starting threads is in it. Bars: {}.",
        confidence(&intervals)
    );
    Some(Block::Figure { stem: "overhead", figure: Box::new(plot) })
}
