//! One generator for all threads against one for each, or none that is shared.

use crate::analysis::quantile::median;
use crate::error::Result;
use crate::measure::{Record, THREAD_PER_ROW};
use crate::plot::Axis;
use crate::plot::dot_plot::{Dot, DotPlot, Group, Row};
use crate::plot::style::Look;
use crate::report::block::{Block, Table};
use crate::report::results::{Results, Schedule, confidence, median_with_interval, with_level};
use std::collections::BTreeMap;

/// Who renders, in words.
fn crew(schedule: &Schedule) -> String {
    if schedule.strategy == THREAD_PER_ROW {
        format!("a thread for each of {} rows", schedule.threads)
    } else {
        schedule.label()
    }
}

fn switches_per_second(record: &Record) -> Option<f64> {
    Some((record.voluntary_switches? + record.involuntary_switches?) as f64 / record.makespan_s?)
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let mut crews: Vec<(usize, String)> =
        results.by(Schedule::of).into_keys().map(|schedule| (schedule.threads, crew(&schedule))).collect();
    crews.sort();
    crews.dedup();
    let (mut rows, mut table, mut intervals) = (Vec::new(), Vec::new(), Vec::new());
    for (sampler, records) in results.by(|record| record.sampler.clone()) {
        let mut by_crew: BTreeMap<String, Vec<&Record>> = BTreeMap::new();
        for record in records {
            by_crew.entry(crew(&Schedule::of(record))).or_default().push(record);
        }
        let mut dots = Vec::new();
        for (_, crew) in &crews {
            let records = by_crew.get(crew).map_or(&[][..], Vec::as_slice);
            let times: Vec<f64> = records.iter().filter_map(|record| record.makespan_s).collect();
            let found = median_with_interval(&times);
            dots.push(found.map(|(value, interval)| Dot {
                value: value * 1e3,
                interval: interval.map(|i| (i.low * 1e3, i.high * 1e3)),
            }));
            if let Some((value, interval)) = found {
                intervals.extend(interval);
                table.push(row(
                    &sampler,
                    crew,
                    records,
                    value,
                    interval.map_or_else(String::new, |i| with_level(&i, 4)),
                ));
            }
        }
        rows.push(Row { name: sampler, dots });
    }
    let mut plot = DotPlot::new("Time by random number generator", Axis::log("milliseconds"), rows);
    plot.groups = crews
        .iter()
        .enumerate()
        .map(|(index, (_, crew))| Group { name: crew.clone(), look: Look::nth(index) })
        .collect();
    plot.subtitle = results.workload();
    plot.caption = format!("Median. Bars: {}.", confidence(&intervals));
    let columns = [
        "generator",
        "threads",
        "median seconds",
        "interval (confidence)",
        "switches per second",
        "CPU / wall",
        "system share of CPU",
    ];
    let columns = columns.map(String::from).to_vec();
    let title = "Generators: medians over repetitions".to_string();
    let mut blocks = vec![Block::Figure { stem: "generators", figure: Box::new(plot) }];
    blocks.extend(finding(results));
    blocks.push(Block::Table { stem: "generators-table", table: Table { title, columns, rows: table } });
    Ok(blocks)
}

fn row(sampler: &str, crew: &str, records: &[&Record], seconds: f64, interval: String) -> Vec<String> {
    let of = |value: &dyn Fn(&Record) -> Option<f64>, digits: usize| {
        let values: Vec<f64> = records.iter().filter_map(|record| value(record)).collect();
        median(&values).map_or_else(|| "-".to_string(), |value| format!("{value:.digits$}"))
    };
    vec![
        sampler.to_string(),
        crew.to_string(),
        format!("{seconds:.4}"),
        interval,
        of(&switches_per_second, 0),
        of(&|record| Some(record.cpu_s()? / record.makespan_s?), 2),
        of(&|record| Some(record.cpu_system_s? / record.cpu_s()?), 2),
    ]
}

fn finding(results: &Results) -> Option<Block> {
    let kind = |sampler: &'static str, threads: usize| {
        move |record: &Record| {
            record.sampler == sampler && record.threads == threads && record.strategy != "thread-per-job"
        }
    };
    let ratio = |sampler: &'static str| results.kind_ratio(kind(sampler, 2), kind(sampler, 1));
    let (shared, own) = (ratio("libc-rand")?, ratio("independent")?);
    let switches: Vec<f64> =
        results.records.iter().filter(|record| kind("libc-rand", 2)(record)).filter_map(switches_per_second).collect();
    let verdict = match (shared.interval.low > 1.0, own.interval.high < 1.0) {
        (true, true) => {
            "a second processor makes the program with the shared generator slower, and the other one faster"
        }
        _ => "this run does not show the collapse beyond doubt",
    };
    Some(Block::Finding(format!(
        "Two threads take {:.2} times as long as one, {}, when both draw from the C library's rand(), with {:.0} switches per second; with addressed numbers {:.2} times, {}: {verdict}.",
        shared.value,
        with_level(&shared.interval, 2),
        median(&switches)?,
        own.value,
        with_level(&own.interval, 2),
    )))
}
