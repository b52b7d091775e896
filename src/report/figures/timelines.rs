//! Who did what when: a lane for each worker, and where workers times makespan went.

use crate::analysis::balance::Balance;
use crate::error::Result;
use crate::measure::Record;
use crate::report::block::{Block, Table};
use crate::report::results::{Results, Schedule};
use crate::report::timeline;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let processors = results.run.machine.processors;
    let (mut schedules, mut rows) = (Vec::new(), Vec::new());
    let mut groups: Vec<(Schedule, Vec<&Record>)> = results.by(Schedule::of).into_iter().collect();
    groups.sort_by_key(|(schedule, _)| (schedule.threads > processors, schedule.strategy != "serial"));
    for (schedule, records) in groups {
        let Some(record) = Results::typical(&records) else { continue };
        let Some(trace) = results.trace(record)? else { continue };
        let Some(balance) = timeline::balance(&trace) else { continue };
        schedules.push(timeline::lanes(&trace, &balance));
        rows.push(row(&timeline::name(&trace), &balance, schedule.threads <= processors));
    }
    let columns = ["schedule", "jobs", "makespan, ms", "busy", "gaps", "tail", "load imbalance", "gap per job, µs"];
    let title = "Where workers times makespan went".to_string();
    let mut chart = timeline::charts(schedules, results.workload());
    chart.caption = format!("Of each schedule the run with the median time. {}", chart.caption);
    Ok(vec![
        Block::Figure { stem: "timelines", figure: Box::new(chart) },
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
