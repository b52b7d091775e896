//! Timelines: a lane for each worker, and the shares of workers times makespan.

use crate::analysis::balance::Balance;
use crate::measure::TimingConcerns;
use crate::plot::Schedule;
use crate::prelude::*;
use crate::timeline;

/// A run, its balance, and whether it had a processor for each worker.
type Run = (String, Balance, bool);

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let processors = results.run.machine.processors;
    let (mut own, mut shared, mut runs) = (Vec::new(), Vec::new(), Vec::<Run>::new());
    let groups = results.by(|row| (&row.schedule, results.series_name(row), row.spp));
    let mut groups: Vec<_> = groups.into_iter().collect();
    groups.sort_by_key(|((schedule, ..), _)| (schedule.key.threads > processors, !schedule.is_serial()));
    for ((schedule, series, _), rows) in groups {
        // A disturbed run shows the disturbance instead of the schedule.
        let quiet: Vec<&Row> = rows.iter().copied().filter(|row| !TimingConcerns::concern(&row.warnings)).collect();
        let Some(row) = Results::typical(&quiet).or_else(|| Results::typical(&rows)) else { continue };
        let Some(trace) = results.trace(row)? else { continue };
        let Some(balance) = timeline::balance(&trace) else { continue };
        let lanes = timeline::lanes(&trace, &balance, processors);
        if schedule.key.threads > processors {
            shared.push(lanes);
        } else {
            own.push((schedule.is_serial(), lanes));
        }
        runs.push((joined([timeline::name(&trace), series]), balance, schedule.key.threads <= processors));
    }
    // An empty figure would replace the one that the traces gave.
    if runs.is_empty() {
        return Ok(vec![Block::notice("This folder has no traces, so nothing can be drawn job by job.")]);
    }
    // A serial run takes as long as all workers together, so its lane would leave the others in a part of the width.
    let has_parallel = own.iter().any(|(is_serial, _)| !is_serial);
    let (serial, others): (Vec<_>, Vec<_>) = own.into_iter().partition(|(is_serial, _)| has_parallel && *is_serial);
    let alone: Vec<String> = serial.into_iter().map(|(_, lanes)| format!(" Not drawn: {}.", lanes.title)).collect();
    let chart = |title: Title, schedules: Vec<Schedule>, more: &str| {
        let mut chart = timeline::charts(schedules, results.workload());
        chart.title = title;
        chart.caption = format!(
            "Of each schedule the run with the median time, if possible of those without doubts. {}{more}",
            chart.caption
        );
        chart
    };
    let mut blocks = Vec::new();
    let others: Vec<Schedule> = others.into_iter().map(|(_, lanes)| lanes).collect();
    if !others.is_empty() {
        let title = Title::new(timeline::TITLE).with_result(idle(&runs));
        blocks.push(Block::figure("timelines", chart(title, others, &alone.concat())));
    }
    // A job that shares a processor takes longer by its waiting, so these jobs have a colour scale of their own.
    if !shared.is_empty() {
        let title = format!("{} with more threads than {}", timeline::TITLE, counted(processors, "processor"));
        let more = " The time of a job includes its waiting for a processor.";
        blocks.push(Block::figure("timelines-oversubscribed", chart(title.into(), shared, more)));
    }
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
    blocks.push(table);
    Ok(blocks)
}

/// The result in a line: the runs whose workers are idle least and most, among those with a processor for each worker.
fn idle(runs: &[Run]) -> Option<String> {
    let parallel = runs.iter().filter(|(_, balance, alone)| *alone && balance.workers.len() > 1);
    let shares = parallel.map(|(name, balance, _)| (name, 1.0 - balance.utilisation()));
    let shares: Vec<(&String, f64)> = shares.collect();
    let (busy, least) = shares.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (lazy, most) = shares.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let [least, most] = [*least, *most].map(titles::percent);
    (least != most)
        .then(|| format!("In these runs, workers are idle for {least} of the time with {busy}, {most} with {lazy}"))
}
