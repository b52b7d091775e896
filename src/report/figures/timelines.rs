//! Who did what when: a lane for each worker, and where workers times makespan went.

use crate::analysis::balance::{Balance, of_spans};
use crate::error::Result;
use crate::measure::{Record, TraceFile};
use crate::plot::gantt::{GanttChart, JobBar, Schedule as Lanes, Shade};
use crate::report::block::{Block, Table};
use crate::report::results::{Results, Schedule};

/// The balance of a traced run.
pub(crate) fn balance(trace: &TraceFile) -> Option<Balance> {
    let spans = trace.rows.iter().map(|row| (row.worker as usize, row.start_s, row.stop_s));
    of_spans(spans, trace.header.makespan_s, trace.header.workers as usize)
}

/// The lanes of a traced run.
pub(crate) fn lanes(trace: &TraceFile, name: &str, balance: &Balance) -> Lanes {
    let bar = |row: &crate::measure::TraceRow| JobBar {
        worker: row.worker as usize,
        start_s: row.start_s,
        stop_s: row.stop_s,
        value: (row.stop_s - row.start_s) * 1e3,
    };
    let (makespan_s, workers) = (trace.header.makespan_s, trace.header.workers as usize);
    let used = 100.0 * balance.utilisation();
    Lanes {
        title: format!("{name}: {:.1} ms, utilisation {used:.0} %", makespan_s * 1e3),
        workers,
        makespan_s,
        jobs: trace.rows.iter().map(bar).collect(),
    }
}

/// The chart of some runs below each other.
pub(crate) fn chart(schedules: Vec<Lanes>, subtitle: String) -> GanttChart {
    GanttChart {
        title: "Who did what when".to_string(),
        subtitle,
        caption: "Of each schedule the run with the median time. White is waiting; a frame ends at the makespan."
            .to_string(),
        label: "milliseconds of the job".to_string(),
        shade: Shade::Quantile,
        schedules,
    }
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let processors = results.run.machine.processors;
    let (mut schedules, mut rows) = (Vec::new(), Vec::new());
    let mut groups: Vec<(Schedule, Vec<&Record>)> = results.by(Schedule::of).into_iter().collect();
    groups.sort_by_key(|(schedule, _)| (schedule.threads > processors, schedule.strategy != "serial"));
    for (schedule, records) in groups {
        let Some(record) = Results::typical(&records) else { continue };
        let Some(trace) = results.trace(record)? else { continue };
        let Some(balance) = balance(&trace) else { continue };
        let name = format!("{}, {}", schedule.label(), schedule.decomposition);
        schedules.push(lanes(&trace, &name, &balance));
        rows.push(row(&name, &balance, schedule.threads <= processors));
    }
    let columns = ["schedule", "jobs", "makespan, ms", "busy", "gaps", "tail", "load imbalance", "gap per job, µs"];
    let title = "Where workers times makespan went".to_string();
    Ok(vec![
        Block::Figure { stem: "timelines", figure: Box::new(chart(schedules, results.workload())) },
        Block::Table { stem: "balance", table: Table { title, columns: columns.map(String::from).to_vec(), rows } },
    ])
}

/// With more workers than processors most of a job's time is waiting for one, which is no balance.
fn row(name: &str, balance: &Balance, alone: bool) -> Vec<String> {
    let capacity_s = balance.makespan_s * balance.workers.len() as f64;
    let share = |seconds: f64| format!("{:.1} %", 100.0 * seconds / capacity_s);
    let text = |value: Option<f64>, digits: usize| {
        value.filter(|_| alone).map_or_else(|| "-".to_string(), |value| format!("{value:.digits$}"))
    };
    vec![
        name.to_string(),
        balance.jobs().to_string(),
        format!("{:.2}", balance.makespan_s * 1e3),
        share(balance.busy_s()),
        share(balance.gap_s()),
        share(balance.tail_s()),
        text(balance.imbalance(), 3),
        text(balance.overhead_per_job_s().map(|seconds| seconds * 1e6), 2),
    ]
}
