//! What it costs to get pieces into the film, as a multiple of buffers that nobody waits for.

use crate::analysis::quantile::median;
use crate::error::Result;
use crate::measure::{OUTPUTS, Record};
use crate::plot::Axis;
use crate::plot::dot_plot::{Dot, DotPlot, Group, Row};
use crate::plot::style::Look;
use crate::report::block::{Block, Table};
use crate::report::results::{Results, confidence, with_level};

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let kinds: Vec<(String, usize)> =
        results.by(|record| (record.decomposition.clone(), record.threads)).into_keys().collect();
    let (mut rows, mut table, mut intervals) = (Vec::new(), Vec::new(), Vec::new());
    for output in OUTPUTS.iter().filter(|entry| results.records.iter().any(|record| record.output == entry.name)) {
        let mut dots = Vec::new();
        for (decomposition, threads) in &kinds {
            let of = |name: &'static str| {
                move |record: &Record| {
                    record.output == name && record.decomposition == *decomposition && record.threads == *threads
                }
            };
            let ratio =
                results.kind_ratio(of(output.name), of(OUTPUTS[0].name)).filter(|_| output.name != OUTPUTS[0].name);
            let mine: Vec<&Record> = results.records.iter().filter(|record| of(output.name)(record)).collect();
            let typical = |value: fn(&Record) -> Option<f64>, digits: usize| {
                let values: Vec<f64> = mine.iter().filter_map(|record| value(record)).collect();
                median(&values).map_or_else(|| "-".to_string(), |value| format!("{value:.digits$}"))
            };
            intervals.extend(ratio.map(|ratio| ratio.interval));
            dots.push(ratio.map(|r| Dot { value: r.value, interval: Some((r.interval.low, r.interval.high)) }));
            table.push(vec![
                output.name.to_string(),
                decomposition.clone(),
                threads.to_string(),
                typical(|r| Some(r.makespan_s? * 1e3), 3),
                ratio.map_or_else(|| "1".to_string(), |r| format!("{:.3}, {}", r.value, with_level(&r.interval, 3))),
                typical(|r| Some(r.merge_s? * 1e3), 3),
                typical(|r| Some(r.peak_rss_bytes? as f64 / f64::from(1 << 20)), 1),
                typical(|r| Some(r.voluntary_switches? as f64), 0),
            ]);
        }
        if dots.iter().any(Option::is_some) {
            rows.push(Row { name: output.name.to_string(), dots });
        }
    }
    let mut plot = DotPlot::new(
        "Time by output, against slots",
        Axis::linear("time / time with slots").including([0.95, 1.05]),
        rows,
    );
    let group = |(index, (decomposition, threads)): (usize, &(String, usize))| Group {
        name: format!("{decomposition}, {threads} thread{}", if *threads == 1 { "" } else { "s" }),
        look: Look::nth(index),
    };
    plot.groups = kinds.iter().enumerate().map(group).collect();
    plot.guides = vec![(1.0, "slots".to_string())];
    plot.subtitle = results.workload();
    plot.caption = format!("Median of ratios within a repetition. Bars: {}.", confidence(&intervals));
    let columns = [
        "output",
        "pieces",
        "threads",
        "median ms",
        "time / time with slots",
        "ms to put the film together",
        "peak memory, MiB",
        "voluntary switches",
    ];
    let title = "Outputs: medians over repetitions".to_string();
    Ok(vec![
        Block::Figure { stem: "outputs", figure: Box::new(plot) },
        Block::Table {
            stem: "outputs-table",
            table: Table { title, columns: columns.map(String::from).to_vec(), rows: table },
        },
    ])
}
