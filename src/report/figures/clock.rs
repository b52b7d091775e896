//! What `clock()` would have claimed: it adds up the CPU time of all threads, so parallelism never shows in it.

use crate::analysis::quantile::median;
use crate::error::Result;
use crate::measure::Record;
use crate::report::block::{Block, Table};
use crate::report::results::{Results, Schedule};

/// Median wall seconds, median CPU seconds.
type Times = (f64, f64);

fn times(records: &[&Record]) -> Option<Times> {
    let median_of = |value: fn(&Record) -> Option<f64>| {
        median(&records.iter().filter_map(|record| value(record)).collect::<Vec<_>>())
    };
    Some((median_of(|r| r.makespan_s)?, median_of(Record::cpu_s)?))
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let groups = results.by(Schedule::of);
    let timed: Vec<(&Schedule, Times)> =
        groups.iter().filter_map(|(schedule, records)| Some((schedule, times(records)?))).collect();
    let Some((_, serial)) = timed.iter().find(|(schedule, _)| schedule.strategy == "serial").copied() else {
        return Ok(Vec::new());
    };
    let row = |(schedule, (wall_s, cpu_s)): &(&Schedule, Times)| {
        vec![
            schedule.strategy.clone(),
            schedule.threads.to_string(),
            format!("{wall_s:.4}"),
            format!("{cpu_s:.4}"),
            format!("{:.2}", cpu_s / wall_s),
            format!("{:.3}", serial.0 / wall_s),
            format!("{:.3}", serial.1 / cpu_s),
        ]
    };
    let columns = [
        "strategy",
        "threads",
        "wall seconds",
        "CPU seconds, as clock() counts",
        "CPU / wall",
        "speedup by wall time",
        "speedup that clock() would claim",
    ];
    let rows: Vec<Vec<String>> = timed.iter().map(row).collect();
    let processors = results.run.machine.processors;
    let parallel: Vec<f64> = timed
        .iter()
        .filter(|(schedule, _)| schedule.threads == processors && schedule.strategy != "serial")
        .map(|(_, (_, cpu_s))| serial.1 / cpu_s)
        .collect();
    let title = "Wall time and CPU time: medians over repetitions".to_string();
    let mut blocks = Vec::new();
    if let Some(claimed) = median(&parallel) {
        blocks.push(Block::Finding(format!(
            "Timed with clock(), which a comment in report A's listing proposes, {processors} threads would seem to bring a speedup of {claimed:.2} \
             (median over the strategies): clock() adds up the CPU time of all threads, and the work stays the same. All other numbers here are wall time."
        )));
    }
    blocks.push(Block::Table {
        stem: "clock",
        table: Table { title, columns: columns.map(String::from).to_vec(), rows },
    });
    Ok(blocks)
}
