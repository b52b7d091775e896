//! What accuracy costs in time: error against seconds, a line for each schedule. All schedules of one spp have the same image and so the
//! same error; a better schedule moves the curve to the left.

use crate::analysis::quantile::median;
use crate::error::Result;
use crate::plot::style::Look;
use crate::plot::{Axis, LineChart, Point, Series};
use crate::report::block::{Block, Table};
use crate::report::results::{Results, Schedule, median_with_interval};
use std::collections::BTreeMap;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let mut lines: BTreeMap<Schedule, Vec<Point>> = BTreeMap::new();
    let mut rows = Vec::new();
    let mut prices: BTreeMap<Schedule, Vec<f64>> = BTreeMap::new();
    for ((schedule, spp), records) in results.by(|record| (Schedule::of(record), record.spp)) {
        let by_seed: BTreeMap<u64, f64> = records.iter().filter_map(|record| Some((record.seed, record.mse?))).collect();
        let mse = by_seed.values().sum::<f64>() / by_seed.len().max(1) as f64;
        let times: Vec<f64> = records.iter().filter_map(|record| record.makespan_s).collect();
        let Some((seconds, interval)) = median_with_interval(&times) else { continue };
        if mse.is_nan() || mse <= 0.0 {
            continue;
        }
        let bar = interval.map(|interval| (interval.low, interval.high));
        rows.push(vec![
            label(&schedule),
            spp.to_string(),
            format!("{seconds:.4}"),
            bar.map_or_else(|| "one run".to_string(), |(low, high)| format!("{low:.4} to {high:.4}")),
            format!("{:.5}", mse.sqrt()),
            format!("{:.3e}", mse * seconds),
        ]);
        prices.entry(schedule.clone()).or_default().push(mse * seconds);
        lines.entry(schedule).or_default().push(Point::new(seconds, mse.sqrt()).with_x(bar));
    }
    let mut strategies: Vec<String> = lines.keys().map(|schedule| schedule.strategy.clone()).collect();
    strategies.dedup();
    let mut dashes: Vec<usize> = lines.keys().map(|schedule| schedule.threads).collect();
    dashes.sort_unstable();
    dashes.dedup();
    let position = |list: &[String], name: &str| list.iter().position(|item| item == name).unwrap_or(0);
    let series: Vec<Series> = lines
        .into_iter()
        .map(|(schedule, points)| {
            let dash = dashes.iter().position(|threads| *threads == schedule.threads).unwrap_or(0);
            Series::new(label(&schedule), Look::of(position(&strategies, &schedule.strategy), dash), points)
        })
        .collect();
    let mut chart = LineChart::new(
        "What accuracy costs in time",
        Axis::log("wall seconds"),
        Axis::log("RMSE, linear radiance"),
        series,
    );
    chart.subtitle = results.workload();
    chart.caption = "Points along a line: growing samples per pixel. Bars: interval of the median time.".to_string();
    let price = price_finding(&prices);
    let columns = ["schedule", "spp", "median seconds", "interval", "RMSE, linear", "MSE x seconds"].map(String::from).to_vec();
    let table = Table { title: "Price of accuracy by schedule".to_string(), columns, rows };
    let mut blocks = vec![Block::Figure { stem: "rmse-against-time", figure: Box::new(chart) }];
    blocks.extend(price);
    blocks.push(Block::Table { stem: "rmse-against-time", table });
    Ok(blocks)
}

/// Error times root of time is constant along a line, so one number prices every accuracy: MSE times seconds.
fn price_finding(prices: &BTreeMap<Schedule, Vec<f64>>) -> Option<Block> {
    const ACCURACY: f64 = 0.01;
    let seconds = |values: &Vec<f64>| Some(median(values)? / (ACCURACY * ACCURACY));
    let costs: Vec<(&Schedule, f64)> = prices.iter().filter_map(|(schedule, values)| Some((schedule, seconds(values)?))).collect();
    let (cheapest, least) = costs.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (dearest, most) = costs.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Block::Finding(format!(
        "MSE times seconds is the price of accuracy: it hardly changes along a line. Extrapolated with it, an RMSE of {ACCURACY} costs about \
         {least:.0} s with {} and {most:.0} s with {}; half that RMSE costs four times as much. These seconds were not measured.",
        label(cheapest),
        label(dearest),
    )))
}

fn label(schedule: &Schedule) -> String {
    match schedule.threads {
        1 => format!("{}, 1 thread", schedule.strategy),
        threads => format!("{}, {threads} threads", schedule.strategy),
    }
}
