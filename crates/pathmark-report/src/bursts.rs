//! Statistics of bursts, which `pathmark bursts` prints and the page shows: each strategy after gaps of each length,
//! compared with one of the strategies.

use crate::analysis::adjacent_pairs::{by_process, paired_ratio};
use crate::analysis::quantile::median;
use crate::error::{InputError, Result};
use crate::estimated::{Estimated, LEVEL};
use crate::measure::BurstRow;
use crate::paired::ratios_by;
use crate::plot::number::short;
use serde::Serialize;
use std::path::Path;

/// The folder within results, and its file of rows.
pub const FOLDER: &str = "bursts";
pub const FILE: &str = "bursts.csv";

/// The strategy that the others are compared with, if it takes part.
const USUAL_YARDSTICK: &str = "rayon";

/// Whether a folder of results has bursts.
pub fn are_in(out: &Path) -> bool {
    out.join(FOLDER).join(FILE).is_file()
}

/// A strategy after gaps of one length.
#[derive(Debug, Serialize)]
pub struct Line {
    pub gap_s: f64,
    pub strategy: String,
    /// Medians over turns.
    pub wake_s: f64,
    pub wake_p95_s: f64,
    pub region_s: f64,
    pub ideal_s: f64,
    pub idle_processors: Option<f64>,
    pub started: f64,
    /// Over those of the yardstick in the same round. Fewer than three processes give no interval.
    pub wake_ratio: Option<Estimated>,
    pub region_ratio: Option<Estimated>,
}

/// The strategy that all others are compared with, unless the user names another: rayon, or else the first.
pub fn usual_yardstick(strategies: &[String]) -> Option<&str> {
    strategies.iter().find(|own| *own == USUAL_YARDSTICK).or(strategies.first()).map(String::as_str)
}

/// The strategies of rows, in the order in which they first occur.
pub(crate) fn strategies(rows: &[BurstRow]) -> Vec<String> {
    distinct(rows.iter().map(|row| row.strategy.clone()))
}

fn distinct<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    values.fold(Vec::new(), |mut found, value| {
        if !found.contains(&value) {
            found.push(value);
        }
        found
    })
}

/// A line for each gap and strategy, in the order in which they first occur in the rows.
pub fn lines(rows: &[BurstRow], yardstick: &str) -> Result<Vec<Line>> {
    let strategies = strategies(rows);
    let mut lines = Vec::new();
    // By its bits: a file may hold a gap that equals no number.
    for gap in distinct(rows.iter().map(|row| row.gap_s.to_bits())) {
        let of = |name: &str| -> Vec<Turn<'_>> {
            let own = rows.iter().filter(|row| row.strategy == name && row.gap_s.to_bits() == gap);
            own.map(|row| ((row.process, row.round), row)).collect()
        };
        for name in &strategies {
            // The yardstick has no ratio to itself.
            let others = if name == yardstick { Vec::new() } else { of(yardstick) };
            lines.push(line(&of(name), &others, f64::from_bits(gap), name)?);
        }
    }
    Ok(lines)
}

/// A row with its process and round.
type Turn<'a> = ((u32, u32), &'a BurstRow);

fn line(own: &[Turn<'_>], others: &[Turn<'_>], gap_s: f64, name: &str) -> Result<Line> {
    let typical = |value: fn(&BurstRow) -> f64| {
        median(&own.iter().map(|(_, row)| value(row)).collect::<Vec<_>>()).unwrap_or(f64::NAN)
    };
    let idle: Vec<f64> = own.iter().filter_map(|(_, row)| row.idle_processors).collect();
    Ok(Line {
        gap_s,
        strategy: name.to_string(),
        wake_s: typical(|row| row.wake_s),
        wake_p95_s: typical(|row| row.wake_p95_s),
        region_s: typical(|row| row.region_s),
        ideal_s: typical(BurstRow::ideal_s),
        idle_processors: median(&idle),
        started: typical(|row| row.started),
        wake_ratio: ratio(own, others, |row| row.wake_s)?,
        region_ratio: ratio(own, others, |row| row.region_s)?,
    })
}

/// A value over the yardstick's in the same round.
fn ratio(own: &[Turn<'_>], others: &[Turn<'_>], value: fn(&BurstRow) -> f64) -> Result<Option<Estimated>> {
    let of_two = |row: &BurstRow, _: &BurstRow| {
        let problem = format!("{} has two rows for a gap of {} s in one round", row.strategy, row.gap_s);
        InputError::new("process, round", format!("{}, {}", row.process, row.round), problem)
    };
    let found = ratios_by(own.iter().copied(), others.iter().copied(), of_two, |row| Some(value(row)))?;
    let processes = by_process(found.iter().map(|(row, ratio)| (row.process, *ratio)));
    let all: Vec<f64> = found.into_iter().map(|(_, ratio)| ratio).collect();
    let ratio = match paired_ratio(&processes, LEVEL) {
        Some(found) => Some(Estimated::from(found.ratio)),
        None => median(&all).map(|value| Estimated::of(value, None)),
    };
    Ok(ratio.map(|ratio| Estimated { count: Some(processes.len()), ..ratio }))
}

/// The strategy that wakes faster than the yardstick after gaps of one length, its regions, and the price of its waiting.
pub fn verdict(lines: &[Line], yardstick: &str) -> String {
    let gap = short(lines.first().map_or(f64::NAN, |line| 1e6 * line.gap_s), 4);
    let faster = lines.iter().filter_map(|line| Some((line, line.wake_ratio?)));
    let is_faster = |ratio: &Estimated| ratio.interval.is_some_and(|interval| interval.high < 1.0);
    let fastest = faster.filter(|(_, ratio)| is_faster(ratio)).min_by(|a, b| a.1.value.total_cmp(&b.1.value));
    let Some((line, ratio)) = fastest else {
        return format!("After gaps of {gap} us, no strategy wakes faster than {yardstick} beyond the noise.");
    };
    let idle = |name: &str| {
        let found = lines.iter().find(|line| line.strategy == name).and_then(|line| line.idle_processors);
        found.map_or_else(|| "an unknown number of".to_string(), |idle| format!("{idle:.2}"))
    };
    let regions = line.region_ratio.as_ref().map_or_else(|| "an unknown number of".to_string(), in_words);
    format!(
        "After gaps of {gap} us, {} wakes fastest, in {} times the time of {yardstick}. Its regions take {regions} times as long. In the gaps it keeps {} processors busy, and {yardstick} keeps {}.",
        line.strategy,
        in_words(&ratio),
        idle(&line.strategy),
        idle(yardstick),
    )
}

/// A ratio with its interval, if it has one.
pub fn in_words(ratio: &Estimated) -> String {
    let digits = if ratio.value < 0.1 { 3 } else { 2 };
    let interval = ratio.interval.map(|interval| format!(" ({:.digits$} to {:.digits$})", interval.low, interval.high));
    format!("{:.digits$}{}", ratio.value, interval.unwrap_or_default())
}
