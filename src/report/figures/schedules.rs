//! A table of what each schedule did: time, balance, switches.

use crate::analysis::quantile::median;
use crate::error::Result;
use crate::measure::Record;
use crate::report::block::{Block, Table};
use crate::report::results::{Results, Schedule, median_with_interval, with_level};

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let columns = [
        "image",
        "spp",
        "strategy",
        "pieces",
        "threads",
        "jobs",
        "runs",
        "median seconds",
        "interval (confidence)",
        "CPU / wall",
        "load imbalance",
        "longest job, ms",
        "voluntary switches",
        "forced switches",
    ];
    let processors = results.run.machine.processors;
    let groups = results.by(|record| (results.series_name(record), record.spp, Schedule::of(record)));
    let row = |((series, spp, schedule), records): (&(String, u32, Schedule), &Vec<&Record>)| {
        let image = if series.is_empty() { records.first()?.scene.clone() } else { series.clone() };
        Some([vec![image, spp.to_string()], row(schedule, records, processors)?].concat())
    };
    let rows = groups.iter().filter_map(row).collect();
    let title = "Schedules: medians over repetitions".to_string();
    let table = Table { title, columns: columns.map(String::from).to_vec(), rows };
    Ok(vec![Block::Table { stem: "schedules", table }])
}

fn row(schedule: &Schedule, records: &[&Record], processors: usize) -> Option<Vec<String>> {
    let of = |value: &dyn Fn(&Record) -> Option<f64>| {
        median(&records.iter().filter_map(|record| value(record)).collect::<Vec<_>>())
    };
    let text =
        |value: Option<f64>, digits: usize| value.map_or_else(|| "-".to_string(), |value| format!("{value:.digits$}"));
    let times: Vec<f64> = records.iter().filter_map(|record| record.makespan_s).collect();
    let (median, interval) = median_with_interval(&times)?;
    // A job's seconds include waiting for a processor: with more workers than processors they say nothing about balance.
    let alone = |record: &Record| (record.workers_used? as usize <= processors).then_some(());
    let imbalance = |record: &Record| {
        alone(record).and(Some(record.busy_max_s? * f64::from(record.workers_used?) / record.busy_sum_s? - 1.0))
    };
    Some(vec![
        schedule.strategy.clone(),
        schedule.decomposition.clone(),
        schedule.threads.to_string(),
        records.first()?.jobs.to_string(),
        times.len().to_string(),
        format!("{median:.4}"),
        interval.map_or_else(|| "one run".to_string(), |interval| with_level(&interval, 4)),
        text(of(&|record| Some(record.cpu_s()? / record.makespan_s?)), 2),
        text(of(&imbalance), 3),
        text(of(&|record| alone(record).and(Some(record.job_max_s? * 1e3))), 1),
        text(of(&|record| Some(record.voluntary_switches? as f64)), 0),
        text(of(&|record| Some(record.involuntary_switches? as f64)), 0),
    ])
}
