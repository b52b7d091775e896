//! The price list of the guards: `guards/guards.csv`, which `pathmark check --out` and `reproduce` write.

use super::block::{Block, Table};
use super::page::Section;
use crate::check::guards::{FILE, FOLDER, PriceRow, read_prices};
use crate::error::Result;
use crate::experiment::{Chapter, read_run_file};
use crate::measure::Doubts;
use crate::plot::{Axis, Dot, DotPlot, Row, number};
use std::path::Path;

const QUESTION: &str = "What does it cost to be right on hard inputs, and how wrong is what would do on easy ones?";

const ANALYSIS: &str = "A guard is extra work that keeps hard inputs correct; on easy inputs a simpler method would do. Both are tried on the same hard inputs against the exact answer, and timed by turns on the same work. \
A ratio above 1 is what the guard costs in the operation that it guards; in an image it is far less, because an image does much besides. Where the ratio is below 1, being right is also faster.\n\n\
The simpler variants are not options of the program: a table of hard cases (`pathmark check`) insists that the program passes where they fail.";

/// The section, if a folder has such a list. Its figure and table are written beside it.
pub(super) fn section(out: &Path) -> Result<Option<Section>> {
    let folder = out.join(FOLDER);
    let path = folder.join(FILE);
    if !path.is_file() {
        return Ok(None);
    }
    let rows = read_prices(&path)?;
    let run = read_run_file(&folder.join("machine.toml"))?;
    let blocks = vec![
        Block::Figure { stem: "guards", figure: Box::new(plot(&rows, run.machine.line())) },
        Block::Table { stem: "price-list", table: prices(&rows) },
        Block::Table { stem: "meanings", table: meanings(&rows) },
    ];
    for block in &blocks {
        block.save(&folder.join("figures"))?;
    }
    Ok(Some(Section {
        name: FOLDER.to_string(),
        title: "What being right costs: the guards".to_string(),
        question: QUESTION.to_string(),
        analysis: ANALYSIS.to_string(),
        chapter: Some(Chapter::HardInputs),
        place: 0,
        in_short: None,
        failed: Vec::new(),
        doubts: Doubts::default(),
        rows: rows.len(),
        run,
        blocks,
    }))
}

fn plot(rows: &[PriceRow], machine: String) -> DotPlot {
    let dot =
        |row: &PriceRow| Some(Dot { value: row.time_ratio?, interval: row.time_ratio_low.zip(row.time_ratio_high) });
    let named = rows.iter().map(|row| Row { name: row.guard.clone(), dots: vec![dot(row)] }).collect();
    let mut plot = DotPlot::new("What each guard costs", Axis::log("time with the guard / time without"), named);
    plot.subtitle = machine;
    plot.caption = "Bars: distribution-free 95 % interval of the median over paired rounds. The table says what goes wrong without each guard.".to_string();
    plot.guides = vec![(1.0, "as fast".to_string())];
    plot
}

fn prices(rows: &[PriceRow]) -> Table {
    let columns = ["guard", "error with it", "error without", "ns with it", "ns without", "time with / without"];
    let short = |value: f64| number::short(value, 3);
    let error = |value: f64, low: f64, high: f64| {
        if low < high { format!("{} ({} to {})", short(value), short(low), short(high)) } else { short(value) }
    };
    let cell = |value: Option<f64>| value.map_or_else(|| "-".to_string(), short);
    let row = |row: &PriceRow| {
        let ratio = match (row.time_ratio, row.time_ratio_low, row.time_ratio_high) {
            (Some(value), Some(low), Some(high)) => format!("{value:.2} ({low:.2} to {high:.2})"),
            _ => "-".to_string(),
        };
        vec![
            row.guard.clone(),
            error(row.error_with, row.error_with_low, row.error_with_high),
            error(row.error_without, row.error_without_low, row.error_without_high),
            cell(row.ns_with),
            cell(row.ns_without),
            ratio,
        ]
    };
    let title = "Price list of the guards, intervals of 95 %".to_string();
    Table { title, columns: columns.map(String::from).to_vec(), rows: rows.iter().map(row).collect() }
}

fn meanings(rows: &[PriceRow]) -> Table {
    let columns = ["guard", "the program's way", "the other way", "what the error is", "what is timed"];
    let row =
        |row: &PriceRow| [&row.guard, &row.with, &row.without, &row.error, &row.operation].map(String::clone).to_vec();
    let title = "What is compared".to_string();
    Table { title, columns: columns.map(String::from).to_vec(), rows: rows.iter().map(row).collect() }
}
