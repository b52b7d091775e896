//! The speedups that `clock()` would show: it adds up the CPU time of all threads, so it never shows a gain by
//! parallelism.

use super::prelude::*;

/// Median wall seconds and CPU seconds of a schedule.
struct Times<'a> {
    schedule: &'a Schedule,
    wall_s: f64,
    cpu_s: f64,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let times = results.by_schedule().into_iter().filter_map(|(schedule, rows)| {
        let wall_s = typical(rows.iter().copied(), |row| row.makespan_s)?;
        Some(Times { schedule, wall_s, cpu_s: typical(rows, |row| row.cpu_s())? })
    });
    let times: Vec<Times<'_>> = times.collect();
    let Some(serial) = times.iter().find(|times| times.schedule.is_serial()) else { return Ok(Vec::new()) };
    let processors = results.processors();
    let parallel = times.iter().filter(|t| t.schedule.key.threads == processors && !t.schedule.is_serial());
    let claimed = median(&parallel.map(|times| serial.cpu_s / times.cpu_s).collect::<Vec<f64>>());
    let finding = claimed.map(|claimed| {
        Block::finding(format!(
            "Timed with clock(), which a comment in report A's listing proposes, {processors} threads would seem to bring a speedup of {claimed:.2} \
             (median over the strategies): clock() adds up the CPU time of all threads, and the work stays the same. All other numbers here are wall time."
        ))
    });
    let table = Block::table("clock", "Wall time and CPU time: medians over repetitions", &times)
        .column("strategy", |times| times.schedule.name.clone())
        .column("threads", |times| times.schedule.key.threads.to_string())
        .number("wall seconds", Decimals(4), |times| times.wall_s)
        .number("CPU seconds, as clock() counts", Decimals(4), |times| times.cpu_s)
        .number("CPU / wall", Decimals(2), |times| times.cpu_s / times.wall_s)
        .number("speedup by wall time", Decimals(3), |times| serial.wall_s / times.wall_s)
        .number("speedup that clock() would claim", Decimals(3), |times| serial.cpu_s / times.cpu_s)
        .end();
    Ok(finding.into_iter().chain([table]).collect())
}
