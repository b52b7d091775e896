//! A table of schedules: time, balance, context switches.

use crate::prelude::*;

/// The rows of an image under a schedule, and their median time.
struct Line<'a> {
    image: String,
    first: &'a Row,
    rows: Vec<&'a Row>,
    times: Vec<f64>,
    seconds: Estimated,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let processors = results.run.machine.processors;
    let groups = results.by(|row| (results.series_name(row), row.spp, &row.schedule));
    let lines = groups.into_iter().filter_map(|((series, ..), rows)| {
        let first = *rows.first()?;
        let image = if series.is_empty() { first.scene.clone() } else { series };
        let times = values(&rows, |row| row.makespan_s);
        Some(Line { image, first, seconds: Estimated::typical(&times, results.stopping())?, times, rows })
    });
    // A job's seconds include waiting for a processor, so with more workers than processors they do not show balance.
    let alone = |row: &Row| (row.workers_used? as usize <= processors).then_some(());
    let imbalance =
        |row: &Row| alone(row).and(Some(row.busy_max_s? * f64::from(row.workers_used?) / row.busy_sum_s? - 1.0));
    Ok(vec![
        Block::table("schedules", "Schedules: typical values over repetitions", lines)
            .column("image", |line| line.image.clone())
            .column("spp", |line| line.first.spp.to_string())
            .column("strategy", |line| line.first.schedule.name.clone())
            .column("pieces", |line| line.first.decomposition.clone())
            .column("threads", |line| line.first.threads.to_string())
            .column("jobs", |line| line.first.jobs.to_string())
            .column("runs", |line| line.times.len().to_string())
            .estimated("seconds", Decimals(4), |line| line.seconds)
            .number("CPU / wall", Decimals(2), |line| typical(&line.rows, |row| Some(row.cpu_s()? / row.makespan_s?)))
            .number("load imbalance", Decimals(3), |line| typical(&line.rows, imbalance))
            .number("longest job, ms", Decimals(1), |line| {
                typical(&line.rows, |row| alone(row).and(Some(row.job_max_s? * 1e3)))
            })
            .number("voluntary switches", Decimals(0), |line| {
                typical(&line.rows, |row| Some(row.voluntary_switches? as f64))
            })
            .number("forced switches", Decimals(0), |line| {
                typical(&line.rows, |row| Some(row.involuntary_switches? as f64))
            })
            .end(),
    ])
}
