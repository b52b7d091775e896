//! The cost of writing pieces into the film, relative to an output whose threads never wait.

use crate::measure::OUTPUTS;
use crate::prelude::*;

/// The output that the others are compared with.
const YARDSTICK: &str = "slots";

/// The rows of an output on the same pieces and threads.
struct Line<'a> {
    output: &'a str,
    decomposition: &'a str,
    threads: usize,
    rows: &'a [&'a Row],
    ratio: Option<Ratio>,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let groups = results.by(|row| (row.output.as_str(), row.decomposition.as_str(), row.threads));
    let kinds: Vec<(&str, usize)> = results.by(|row| (row.decomposition.as_str(), row.threads)).into_keys().collect();
    let outputs = in_table_order(groups.keys().map(|(output, ..)| *output), OUTPUTS.iter().map(|entry| entry.name));
    let of = |(output, (decomposition, threads))| {
        groups.get(&(output, decomposition, threads)).map_or(&[][..], Vec::as_slice)
    };
    let cells = outputs.iter().flat_map(|(_, output)| kinds.iter().map(move |kind| (*output, *kind)));
    let others = cells.clone().filter(|(output, _)| *output != YARDSTICK);
    let pairs = others.map(|cell| (cell, of(cell), of((YARDSTICK, cell.1))));
    let ratios = time_ratios(pairs, |_, schedule| schedule.output.clear(), results.stopping())?;
    let ratios: BTreeMap<_, Ratio> = ratios.into_iter().collect();
    let lines = cells.map(|cell| {
        let (output, (decomposition, threads)) = cell;
        Line { output, decomposition, threads, rows: of(cell), ratio: ratios.get(&cell).copied() }
    });
    let lines: Vec<Line<'_>> = lines.collect();
    let crews: BTreeSet<usize> = lines.iter().map(|line| line.threads).collect();
    let of_pieces = lines.chunk_by(|a, b| (a.output, a.decomposition) == (b.output, b.decomposition));
    let rows = of_pieces.map(|own| {
        let ratio = |threads: &usize| own.iter().find(|line| line.threads == *threads)?.ratio;
        let dots = crews.iter().map(|threads| Some(Estimated::from(ratio(threads)?).dot()));
        DotRow::new(format!("{}, {}", own[0].output, own[0].decomposition), dots.collect())
    });
    let slowest = titles::largest_above_1(lines.iter().filter_map(|line| Some((line, line.ratio?))));
    let result = slowest.map_or_else(
        || format!("No output takes longer than {YARDSTICK} beyond the noise"),
        |(line, ratio)| {
            let crew = counted(line.threads, "thread");
            format!("{} takes {} with {}, {crew}", line.output, titles::longer(ratio.value), line.decomposition)
        },
    );
    let mut plot = DotPlot::new(
        Title::new(format!("Time by output, against {YARDSTICK}"))
            .with_result(lines.iter().any(|line| line.ratio.is_some()).then_some(result)),
        Axis::linear(format!("time / time with {YARDSTICK}")).including([0.95, 1.05]),
        rows.filter(|row| row.dots.iter().any(Option::is_some)).collect(),
    )
    .in_areas(crews.iter().map(|threads| counted(*threads, "thread")));
    plot.guides = vec![(1.0, YARDSTICK.to_string())];
    plot.subtitle = results.workload();
    plot.caption = ratio_bars(lines.iter().filter_map(|line| line.ratio));
    // Not every output was tried on all pieces.
    let measured = lines.iter().filter(|line| !line.rows.is_empty());
    let table = Block::table("outputs-table", "Outputs: medians over repetitions", measured)
        .column("output", |line| line.output.to_string())
        .column("pieces", |line| line.decomposition.to_string())
        .column("threads", |line| line.threads.to_string())
        .number("median ms", Decimals(3), |line| typical(line.rows, |row| Some(row.makespan_s? * 1e3)))
        .estimated(format!("time / time with {YARDSTICK}"), Decimals(3), |line| {
            if line.output == YARDSTICK { Some(Estimated::of(1.0, None)) } else { line.ratio.map(Estimated::from) }
        })
        .number("ms to put the film together", Decimals(3), |line| typical(line.rows, |row| Some(row.merge_s? * 1e3)))
        .number("peak memory, MiB", Decimals(1), |line| {
            typical(line.rows, |row| Some(row.peak_rss_bytes? as f64 / f64::from(1 << 20)))
        })
        .number("voluntary switches", Decimals(0), |line| {
            typical(line.rows, |row| Some(row.voluntary_switches? as f64))
        })
        .end();
    Ok(vec![Block::figure("outputs", plot), table])
}
