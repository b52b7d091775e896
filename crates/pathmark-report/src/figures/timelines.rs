//! Timelines: a lane for each worker, and the shares of workers times makespan.

use crate::analysis::balance::Balance;
use crate::prelude::*;
use crate::timeline;

/// A run, its balance, and whether it had a processor for each worker.
type Run = (String, Balance, bool);

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let processors = results.run.machine.processors;
    let (mut schedules, mut runs) = (Vec::new(), Vec::<Run>::new());
    let groups = results.by(|row| (&row.schedule, results.series_name(row), row.spp));
    let mut groups: Vec<_> = groups.into_iter().collect();
    groups.sort_by_key(|((schedule, ..), _)| (schedule.key.threads > processors, !schedule.is_serial()));
    for ((schedule, series, _), rows) in groups {
        let Some(row) = Results::typical(&rows) else { continue };
        let Some(trace) = results.trace(row)? else { continue };
        let Some(balance) = timeline::balance(&trace) else { continue };
        schedules.push(timeline::lanes(&trace, &balance, processors));
        runs.push((joined([timeline::name(&trace), series]), balance, schedule.key.threads <= processors));
    }
    let mut chart = timeline::charts(schedules, results.workload());
    chart.caption = format!("Of each schedule the run with the median time. {}", chart.caption);
    let share = |balance: &Balance, seconds: f64| {
        format!("{:.1} %", 100.0 * seconds / (balance.makespan_s * balance.workers.len() as f64))
    };
    // With more workers than processors, a job mostly waits for a processor, so its time says nothing about balance.
    let table = Block::table("balance", "Where workers times makespan went", &runs)
        .column("schedule", |(name, ..)| name.clone())
        .column("jobs", |(_, balance, _)| balance.jobs().to_string())
        .number("makespan, ms", Decimals(2), |(_, balance, _)| balance.makespan_s * 1e3)
        .column("busy", |(_, balance, _)| share(balance, balance.busy_s()))
        .column("gaps", |(_, balance, _)| share(balance, balance.gap_s()))
        .column("tail", |(_, balance, _)| share(balance, balance.tail_s()))
        .number("load imbalance", Decimals(3), |(_, balance, alone)| balance.imbalance().filter(|_| *alone))
        .column("gap per job, µs", |(_, balance, alone)| {
            let seconds = balance.overhead_per_job_s().filter(|_| *alone);
            seconds.map_or_else(|| "-".to_string(), |seconds| format!("{:.2}", seconds * 1e6))
        })
        .end();
    Ok(vec![Block::figure("timelines", chart), table])
}
