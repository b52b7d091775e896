//! Random number generators: one shared by all threads, one for each thread, or no shared state.

use crate::prelude::*;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Options {
    /// The generators to compare, for the collapse of the shared one on a second thread.
    compare: Option<Compare>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Compare {
    /// A generator that all threads share.
    shared: String,
    /// A generator that no thread waits for.
    own: String,
}

/// The strategy and its threads, in words.
fn crew(schedule: &Schedule) -> String {
    if schedule.is_thread_per_row() {
        format!("a thread for each of {} rows", schedule.key.threads)
    } else {
        schedule.label()
    }
}

fn switches_per_second(row: &Row) -> Option<f64> {
    Some((row.voluntary_switches? + row.involuntary_switches?) as f64 / row.makespan_s?)
}

/// The rows of a generator with one strategy and number of threads.
struct Line<'a> {
    sampler: &'a str,
    /// Workload and crew: generators of one name stand below each other.
    name: String,
    crew: String,
    rows: Vec<&'a Row>,
    seconds: Estimated,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Options { compare } = options(&results.definition, "generators")?;
    // Times of different images must not be mixed.
    let groups = results.by(|row| {
        let threads = row.schedule.key.threads;
        (row.spp, (row.width, row.height), threads, crew(&row.schedule), row.sampler.as_str())
    });
    let differ = |count: usize| count > 1;
    let several_spp = differ(groups.keys().map(|(spp, ..)| spp).collect::<BTreeSet<_>>().len());
    let several_sizes = differ(groups.keys().map(|(_, size, ..)| size).collect::<BTreeSet<_>>().len());
    let name = |spp: u32, (width, height): (u32, u32), crew: &str| {
        let spp = if several_spp { format!("{spp} spp") } else { String::new() };
        let size = if several_sizes { format!("{width}x{height}") } else { String::new() };
        joined([spp, size, crew.to_string()])
    };
    let cells = groups.into_iter().map(|((spp, size, _, crew, sampler), rows)| {
        let any_sampler: Forget = |image, _| image.sampler.clear();
        let seconds = Repeats::means(rows.iter().copied(), any_sampler, |row| row.makespan_s);
        ((sampler, name(spp, size, &crew), crew, rows), seconds)
    });
    let line = |((sampler, name, crew, rows), seconds)| Line { sampler, name, crew, rows, seconds };
    let lines: Vec<Line<'_>> = medians(cells, results.stopping()).into_iter().map(line).collect();
    let samplers: BTreeSet<&str> = lines.iter().map(|line| line.sampler).collect();
    let mut dots: Vec<DotRow> = Vec::new();
    for line in &lines {
        if dots.last().is_none_or(|row| row.name != line.name) {
            dots.push(DotRow::new(&line.name, vec![None; samplers.len()]));
        }
        let places = dots.iter_mut().next_back().into_iter().flat_map(|row| row.dots.iter_mut().zip(&samplers));
        places.filter(|(_, sampler)| **sampler == line.sampler).for_each(|(dot, _)| *dot = Some(line.seconds.dot()));
    }
    let (result, finding) = compare.map_or(Ok(None), |compare| compared(results, &compare))?.unzip();
    let title = Title::new("Time by random number generator").with_result(result.flatten());
    let plot = DotPlot::new(title, Axis::log("seconds"), dots);
    let mut plot = plot.grouped(samplers);
    plot.subtitle = results.workload();
    plot.caption = bars(lines.iter().map(|line| line.seconds));
    let table = Block::table("generators-table", "Generators: typical values over repetitions", &lines)
        .column("generator", |line| line.sampler.to_string())
        .column("samples per pixel", |line| line.rows[0].spp.to_string())
        .column("threads", |line| line.crew.clone())
        .estimated("seconds", Decimals(4), |line| line.seconds)
        .number("switches per second", Decimals(0), |line| typical(&line.rows, switches_per_second))
        .number("CPU / wall", Decimals(2), |line| typical(&line.rows, |row| Some(row.cpu_s()? / row.makespan_s?)))
        .number("system share of CPU", Decimals(2), |line| {
            typical(&line.rows, |row| Some(row.cpu_system_s? / row.cpu_s()?))
        })
        .end();
    Ok([Block::figure("generators", plot)].into_iter().chain(finding).chain([table]).collect())
}

/// Compares two threads with one thread of the same strategy, for both generators: the result in a line, and a finding.
fn compared(results: &Results, Compare { shared, own }: &Compare) -> Result<Option<(Option<String>, Block)>> {
    let of = |sampler: &str, threads: usize| -> Vec<&Row> {
        let rows = results.rows().filter(|row| row.sampler == sampler && row.threads == threads);
        rows.filter(|row| !row.schedule.is_thread_per_row()).collect()
    };
    let ratio = |sampler: &str| {
        time_ratio(of(sampler, 2), of(sampler, 1), |_, schedule| schedule.threads = 0, results.stopping())
    };
    let (Some(slowed), Some(free)) = (ratio(shared)?, ratio(own)?) else { return Ok(None) };
    let Some(switches) = typical(of(shared, 2), switches_per_second) else { return Ok(None) };
    let verdict = match (slowed.interval.low > 1.0, free.interval.high < 1.0) {
        (true, true) => {
            "a second processor makes the program with the shared generator slower, and the other one faster"
        }
        _ => "this run does not show the collapse beyond doubt",
    };
    let drawn = if shared == "libc-rand" { "the C library's rand()" } else { shared };
    let result = (slowed.interval.low > 1.0).then(|| {
        format!("Two threads that share {shared} take {}, compared with one thread", titles::longer(slowed.value))
    });
    let finding = Block::finding(format!(
        "Two threads take {:.2} times as long as one, {}, when both draw from {drawn}, with {switches:.0} switches per second; with addressed numbers {:.2} times, {}: {verdict}.",
        slowed.value,
        with_level(&slowed.interval, 2),
        free.value,
        with_level(&free.interval, 2),
    ));
    Ok(Some((result, finding)))
}
