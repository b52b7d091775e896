//! The speedups that `clock()` would show: it adds up the CPU time of all threads, so it never shows a gain by
//! parallelism.

use crate::prelude::*;

/// The rows of a schedule on one image, and its speedups over the serial run of that image.
struct Line<'a> {
    image: String,
    schedule: &'a Schedule,
    rows: Vec<&'a Row>,
    by_wall: Estimated,
    by_clock: Option<Estimated>,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let serial = results.serial()?;
    let lines: Vec<_> = results.by(|row| (results.series_name(row), row.spp, &row.schedule)).into_iter().collect();
    let speedups = |value: fn(&Row) -> Option<f64>| {
        let own = lines.iter().enumerate().map(|(index, (_, rows))| (index, serial.gains(rows, value)));
        medians(own, results.stopping()).into_iter().collect::<BTreeMap<usize, Estimated>>()
    };
    let (by_wall, by_clock) = (speedups(|row| row.makespan_s), speedups(|row| row.cpu_s()));
    let lines = lines.into_iter().enumerate().filter_map(|(index, ((image, spp, schedule), rows))| {
        let image = joined([image, format!("{spp} spp")]);
        Some(Line { image, schedule, rows, by_wall: *by_wall.get(&index)?, by_clock: by_clock.get(&index).copied() })
    });
    let lines: Vec<Line<'_>> = lines.collect();
    if lines.is_empty() {
        return Ok(Vec::new());
    }
    let processors = results.run.machine.processors;
    let parallel = lines.iter().filter(|line| line.schedule.key.threads == processors && !line.schedule.is_serial());
    let whole = parallel.filter_map(|line| line.by_clock.filter(|told| !told.is_partial));
    let claimed = median(&whole.map(|told| told.value).collect::<Vec<f64>>());
    let finding = claimed.map(|claimed| {
        Block::finding(format!(
            "Timed with clock() of the C library, {} would seem to bring a speedup of {claimed:.2} \
             (median over the strategies): clock() adds up the CPU time of all threads, and the work stays the same. All other numbers here are wall time.",
            counted(processors, "thread")
        ))
    });
    let table = Block::table("clock", "Wall time and CPU time: typical values over repetitions", &lines)
        .column("image", |line| line.image.clone())
        .column("strategy", |line| line.schedule.name.clone())
        .column("pieces", |line| line.schedule.key.decomposition.clone())
        .column("threads", |line| line.schedule.key.threads.to_string())
        .column("runs", |line| line.rows.len().to_string())
        .number("wall seconds", Decimals(4), |line| typical(&line.rows, |row| row.makespan_s))
        .number("CPU seconds, as clock() counts", Decimals(4), |line| typical(&line.rows, |row| row.cpu_s()))
        .number("CPU / wall", Decimals(2), |line| typical(&line.rows, |row| Some(row.cpu_s()? / row.makespan_s?)))
        .number("speedup by wall time", Decimals(3), |line| line.by_wall.value)
        .number("speedup that clock() would claim", Decimals(3), |line| line.by_clock.map(|told| told.value))
        .column("remark", |line| {
            if line.by_wall.is_partial { "fewer repetitions than others: not comparable".into() } else { String::new() }
        })
        .end();
    Ok(finding.into_iter().chain([table]).collect())
}
