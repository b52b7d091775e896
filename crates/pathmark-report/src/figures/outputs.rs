//! The cost of writing pieces into the film, relative to an output whose threads never wait.

use super::prelude::*;
use crate::measure::OUTPUTS;

/// The rows of an output on the same pieces and threads.
struct Line<'a> {
    output: &'a str,
    decomposition: &'a str,
    threads: usize,
    rows: &'a [&'a Row],
    ratio: Option<Ratio>,
}

impl Line<'_> {
    fn typical(&self, value: impl Fn(&Row) -> Option<f64>) -> Option<f64> {
        typical(self.rows.iter().copied(), value)
    }
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let yardstick = yardstick(results, "outputs", "slots")?;
    let groups = results.by(|row| (row.output.as_str(), row.decomposition.as_str(), row.threads));
    let kinds: Vec<(&str, usize)> = results.by(|row| (row.decomposition.as_str(), row.threads)).into_keys().collect();
    let outputs = in_table_order(groups.keys().map(|(output, ..)| *output), OUTPUTS.iter().map(|entry| entry.name));
    let mut cells = Vec::new();
    for (_, output) in &outputs {
        for (decomposition, threads) in kinds.iter().copied() {
            let of = |output| groups.get(&(output, decomposition, threads)).map_or(&[][..], Vec::as_slice);
            let (rows, base) = (of(output), of(&yardstick));
            let times = if *output == yardstick {
                Repeats::default()
            } else {
                let any_output: Forget = |_, schedule| schedule.output.clear();
                ratios(rows.iter().copied(), base.iter().copied(), any_output, |row| row.makespan_s)?
            };
            cells.push((Line { output, decomposition, threads, rows, ratio: None }, times));
        }
    }
    let (mut lines, times): (Vec<Line<'_>>, Vec<Repeats>) = cells.into_iter().unzip();
    for (index, ratio) in estimates(times.into_iter().enumerate(), results.stopping()) {
        lines[index].ratio = Some(ratio);
    }
    let dot = |line: &Line<'_>| Some(Told::from(line.ratio?).dot());
    let rows = lines
        .chunk_by(|a, b| a.output == b.output)
        .map(|own| PlotRow::new(own[0].output, own.iter().map(dot).collect()));
    let mut plot = DotPlot::new(
        format!("Time by output, against {yardstick}"),
        Axis::linear(format!("time / time with {yardstick}")).including([0.95, 1.05]),
        rows.filter(|row| row.dots.iter().any(Option::is_some)).collect(),
    )
    .grouped(kinds.iter().map(|(decomposition, threads)| {
        format!("{decomposition}, {threads} thread{}", if *threads == 1 { "" } else { "s" })
    }));
    plot.guides = vec![(1.0, yardstick.clone())];
    plot.subtitle = results.workload();
    let intervals = lines.iter().filter_map(|line| Some(line.ratio?.interval));
    let hollow = hollow(lines.iter().filter_map(|line| line.ratio.map(Told::from)));
    plot.caption = format!("Median of ratios within a repetition. Bars: {}.{hollow}", confidence(intervals));
    // Not every output was tried on all pieces.
    let measured = lines.iter().filter(|line| !line.rows.is_empty());
    let table = Block::table("outputs-table", "Outputs: medians over repetitions", measured)
        .column("output", |line| line.output.to_string())
        .column("pieces", |line| line.decomposition.to_string())
        .column("threads", |line| line.threads.to_string())
        .number("median ms", Decimals(3), |line| line.typical(|row| Some(row.makespan_s? * 1e3)))
        .told(format!("time / time with {yardstick}"), Decimals(3), |line| {
            if line.output == yardstick { Some(Told::of(1.0, None)) } else { line.ratio.map(Told::from) }
        })
        .number("ms to put the film together", Decimals(3), |line| line.typical(|row| Some(row.merge_s? * 1e3)))
        .number("peak memory, MiB", Decimals(1), |line| {
            line.typical(|row| Some(row.peak_rss_bytes? as f64 / f64::from(1 << 20)))
        })
        .number("voluntary switches", Decimals(0), |line| line.typical(|row| Some(row.voluntary_switches? as f64)))
        .end();
    Ok(vec![Block::figure("outputs", plot), table])
}
