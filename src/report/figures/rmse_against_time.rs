//! What accuracy costs in time: error against seconds, a line for each schedule. All schedules of one spp have the same image and so the
//! same error; a better schedule moves the curve to the left.

use crate::analysis::Interval;
use crate::analysis::quantile::median;
use crate::error::Result;
use crate::plot::style::Look;
use crate::plot::{Axis, LineChart, Point, Series};
use crate::report::block::{Block, Table};
use crate::report::results::{Results, Schedule, confidence, median_with_interval, with_level};
use std::collections::BTreeMap;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let mut lines: BTreeMap<(String, Schedule), Vec<Point>> = BTreeMap::new();
    let mut intervals: Vec<Interval> = Vec::new();
    let mut rows = Vec::new();
    let mut prices: BTreeMap<(String, Schedule), Vec<f64>> = BTreeMap::new();
    for ((key, spp), records) in results.by(|record| ((results.series_name(record), Schedule::of(record)), record.spp))
    {
        let by_seed: BTreeMap<u64, f64> =
            records.iter().filter_map(|record| Some((record.seed, record.mse?))).collect();
        let mse = by_seed.values().sum::<f64>() / by_seed.len().max(1) as f64;
        let times: Vec<f64> = records.iter().filter_map(|record| record.makespan_s).collect();
        let Some((seconds, interval)) = median_with_interval(&times) else { continue };
        if mse.is_nan() || mse <= 0.0 {
            continue;
        }
        let bar = interval.map(|interval| (interval.low, interval.high));
        intervals.extend(interval);
        rows.push(vec![
            label(&key),
            spp.to_string(),
            format!("{seconds:.4}"),
            interval.map_or_else(|| "one run".to_string(), |interval| with_level(&interval, 4)),
            format!("{:.5}", mse.sqrt()),
            format!("{:.3e}", mse * seconds),
        ]);
        prices.entry(key.clone()).or_default().push(mse * seconds);
        lines.entry(key).or_default().push(Point::new(seconds, mse.sqrt()).with_x(bar));
    }
    let mut strategies: Vec<String> =
        lines.keys().map(|(series, schedule)| format!("{series}{}", schedule.strategy)).collect();
    strategies.dedup();
    let mut dashes: Vec<usize> = lines.keys().map(|(_, schedule)| schedule.threads).collect();
    dashes.sort_unstable();
    dashes.dedup();
    let position = |list: &[String], name: &str| list.iter().position(|item| item == name).unwrap_or(0);
    let series: Vec<Series> = lines
        .into_iter()
        .map(|(key, points)| {
            let dash = dashes.iter().position(|threads| *threads == key.1.threads).unwrap_or(0);
            let colour = position(&strategies, &format!("{}{}", key.0, key.1.strategy));
            Series::new(label(&key), Look::of(colour, dash), points)
        })
        .collect();
    let mut chart = LineChart::new(
        "What accuracy costs in time",
        Axis::log("wall seconds"),
        Axis::log("RMSE, linear radiance"),
        series,
    );
    chart.subtitle = results.workload();
    chart.caption = format!("Points along a line: growing samples per pixel. Bars: {}.", confidence(&intervals));
    let price = price_finding(&prices);
    let columns = ["schedule", "spp", "median seconds", "interval (confidence)", "RMSE, linear", "MSE x seconds"]
        .map(String::from)
        .to_vec();
    let table = Table { title: "Price of accuracy by schedule".to_string(), columns, rows };
    let mut blocks = vec![Block::Figure { stem: "rmse-against-time", figure: Box::new(chart) }];
    blocks.extend(price);
    blocks.push(Block::Table { stem: "rmse-against-time", table });
    Ok(blocks)
}

/// If error times the root of time is the same along a line, one number prices every accuracy: MSE times seconds.
fn price_finding(prices: &BTreeMap<(String, Schedule), Vec<f64>>) -> Option<Block> {
    const ACCURACY: f64 = 0.01;
    let spread = |values: &Vec<f64>| {
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        most / values.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let widest = prices.values().map(spread).reduce(f64::max)?;
    let seconds = |values: &Vec<f64>| Some(median(values)? / (ACCURACY * ACCURACY));
    let costs = prices.iter().filter_map(|(key, values)| Some((key, seconds(values)?)));
    let costs: Vec<(&(String, Schedule), f64)> = costs.collect();
    let (cheapest, least) = costs.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (dearest, most) = costs.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Block::Finding(format!(
        "MSE times seconds is the price of accuracy; along no line does its largest value exceed its smallest by more than a factor of \
         {widest:.2}. Extrapolated with its median, an RMSE of {ACCURACY} costs about {least:.0} s with {} and {most:.0} s with {}; half that \
         RMSE costs four times as much. These seconds were not measured.",
        label(cheapest),
        label(dearest),
    )))
}

fn label((series, schedule): &(String, Schedule)) -> String {
    if series.is_empty() { schedule.label() } else { format!("{series}, {}", schedule.label()) }
}
