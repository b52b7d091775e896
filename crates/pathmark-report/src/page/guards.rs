//! The price list of the guards: `guards/guards.csv`, which `pathmark selftest --out` and `reproduce` write.

use crate::experiment::{Chapter, read_run_file};
use crate::guard_prices::{FILE, FOLDER, PriceRow, read_prices};
use crate::page::Section;
use crate::plot::number;
use crate::prelude::*;
use std::path::Path;

const QUESTION: &str = "What does it cost to be right on hard inputs, and how wrong is what would do on easy ones?";

const ANALYSIS: &str = "A guard is extra work that keeps hard inputs correct; on easy inputs a simpler method would do. Both are tried on the same hard inputs against the exact answer, and timed by turns on the same work. \
The figure shows the extra time as a share of a render: the extra nanoseconds of an operation, times the operations of a sample, over the time of a sample. A share below 0 means that being right is also faster.\n\n\
The simpler variants are not options of the program: a table of hard cases (`pathmark selftest`) insists that the program passes where they fail.";

/// The section, if a folder has a price list.
pub(crate) fn section(out: &Path) -> Result<Option<Section>> {
    let folder = out.join(FOLDER);
    let path = folder.join(FILE);
    if !path.is_file() {
        return Ok(None);
    }
    let rows = read_prices(&path)?;
    let run = read_run_file(&folder.join("machine.toml"))?;
    let figure = Block::figure("guards", plot(&rows, run.machine.line()));
    let blocks = [figure].into_iter().chain(answer(&rows)).chain([prices(&rows), meanings(&rows)]).collect();
    Ok(Some(Section {
        name: FOLDER.to_string(),
        title: "What being right costs: the guards".to_string(),
        question: QUESTION.to_string(),
        analysis: ANALYSIS.to_string(),
        chapter: Some(Chapter::HardInputs),
        rows: rows.len(),
        run: Some(run),
        files: vec![format!("{FOLDER}/{FILE}")],
        blocks,
        ..Section::default()
    }))
}

/// The guard that costs most, and what goes wrong without it.
fn answer(rows: &[PriceRow]) -> Option<Block> {
    let priced = || rows.iter().filter_map(|row| Some((row, percent(row)?)));
    let (row, share) = priced().max_by(|a, b| a.1.value.total_cmp(&b.1.value))?;
    let (low, high) = share.bar()?;
    let short = |value: f64| number::short(value, 2);
    let text = format!(
        "{} guards keep hard inputs right. The one that costs most, {}, takes {:.1} % ({low:.1} to {high:.1}) of a render; without it, the {} is {} instead of {}.",
        priced().count(),
        row.guard,
        share.value,
        row.error,
        short(row.error_without),
        short(row.error_with),
    );
    Some(Block::Answer { text, stem: "guards", is_told: high - low <= 4.0 })
}

/// The result in a line: the guard that costs most, if its price is beyond the noise.
fn result(rows: &[PriceRow]) -> Option<String> {
    let priced = rows.iter().filter_map(|row| Some((row, percent(row)?)));
    let certain = priced.filter(|(_, share)| share.interval.is_some_and(|interval| interval.low > 0.0));
    let Some((row, share)) = certain.max_by(|a, b| a.1.value.total_cmp(&b.1.value)) else {
        return Some("No guard costs more than the noise".to_string());
    };
    Some(format!("The guard that costs most, {}, takes {} % of a render", row.guard, titles::told(share)?))
}

fn plot(rows: &[PriceRow], machine: String) -> DotPlot {
    let share = |row: &PriceRow| Some(percent(row).map(|share| share.dot()));
    let mut sorted: Vec<&PriceRow> = rows.iter().filter(|row| row.share.is_some()).collect();
    sorted.sort_by(|a, b| b.share.unwrap_or(0.0).total_cmp(&a.share.unwrap_or(0.0)));
    let name = |row: &PriceRow| format!("{} ({}, {})", row.guard, row.scene, row.often);
    let named = sorted.into_iter().filter_map(|row| Some(DotRow { name: name(row), dots: vec![share(row)?] }));
    let axis = Axis::linear("share of the time of a sample, %").including([0.0]);
    let title = Title::new("What each guard costs in a render").with_result(result(rows));
    let mut plot = DotPlot::new(title, axis, named.collect());
    plot.subtitle = machine;
    plot.caption = "Extra time of the guard's operations in a sample, over the time of a sample of a scene that meets it, scalar kernel on one thread. Below 0 the guard saves time. \
        Bars: 95 % interval over processes. The table says what goes wrong without each guard."
        .to_string();
    plot.guides = vec![(0.0, "no cost".to_string())];
    plot
}

/// The share of a render in percent.
fn percent(row: &PriceRow) -> Option<Estimated> {
    let interval = row.share_low.zip(row.share_high).map(|(low, high)| Interval { low, high, level: LEVEL });
    Some(Estimated { count: row.processes, ..Estimated::of(row.share?, interval) }.times(100.0))
}

fn prices(rows: &[PriceRow]) -> Block {
    let told = |value: f64, low: f64, high: f64| {
        // A value that is not estimated has no interval.
        Estimated::of(value, (low < high).then_some(Interval { low, high, level: LEVEL }))
    };
    let ratio = |row: &PriceRow| Some(told(row.time_ratio?, row.time_ratio_low?, row.time_ratio_high?));
    Block::table("price-list", "Price list of the guards", rows)
        .column("guard", |row| row.guard.clone())
        .estimated("error with it", Significant(3), |row| told(row.error_with, row.error_with_low, row.error_with_high))
        .estimated("error without", Significant(3), |row| {
            told(row.error_without, row.error_without_low, row.error_without_high)
        })
        .estimated("share of a render, %", Decimals(2), |row| percent(row))
        .column("in a render of", |row| row.scene.clone())
        .column("how often", |row| row.often.clone())
        .number("operations in a sample", Significant(3), |row| row.operations)
        .number("ns of a sample", Significant(3), |row| row.render_ns)
        .number("ns with it", Significant(3), |row| row.ns_with)
        .number("ns without", Significant(3), |row| row.ns_without)
        .estimated("time with / without", Decimals(2), |row| ratio(row))
        .end()
}

fn meanings(rows: &[PriceRow]) -> Block {
    Block::table("meanings", "What is compared", rows)
        .column("guard", |row| row.guard.clone())
        .column("the program's way", |row| row.with.clone())
        .column("the other way", |row| row.without.clone())
        .column("what the error is", |row| row.error.clone())
        .column("what is timed", |row| row.operation.clone())
        .end()
}
