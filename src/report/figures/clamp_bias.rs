//! What it costs to clamp each subpixel before averaging: light, and the less of it the more samples there are.

use crate::analysis::mean::{Moments, t_interval};
use crate::error::Result;
use crate::measure::Record;
use crate::plot::style::Look;
use crate::plot::{Axis, LineChart, Point, Series};
use crate::report::block::{Block, Table};
use crate::report::results::{LEVEL, Results};
use std::collections::BTreeMap;

/// What a prototype of the same estimator lost on cornell at 256x192, in per cent (spp, bias).
const PROTOTYPE: [(u32, f64); 5] = [(4, -71.0), (16, -34.0), (40, -8.8), (100, -1.8), (200, -0.4)];

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let rows = |clamp: &'static str| {
        results.records.iter().filter(move |row| row.clamp == clamp && row.mean_radiance.is_some())
    };
    let radiance = |records: &[&Record]| {
        let values: Vec<f64> = records.iter().filter_map(|row| row.mean_radiance).collect();
        Moments::of(&values).mean()
    };
    let by_spp = results.by(|row| (row.clamp.clone(), row.spp));
    let largest = rows("subpixel").map(|row| row.spp).max();
    let limit = largest.and_then(|spp| radiance(by_spp.get(&("subpixel".to_string(), spp))?));
    let plain: Vec<&Record> = rows("").collect();
    let (Some(largest), Some(limit), Some(truth)) = (largest, limit, radiance(&plain)) else {
        let text = "There is no bias to show: it takes rows with and without the clamp.";
        return Ok(vec![Block::Finding(text.to_string())]);
    };
    let (mut points, mut table, mut worst) = (Vec::new(), Vec::new(), 0.0_f64);
    for ((_, spp), records) in by_spp.iter().filter(|((clamp, spp), _)| clamp == "subpixel" && *spp < largest) {
        let losses: Vec<f64> =
            records.iter().filter_map(|row| Some(100.0 * (row.mean_radiance? / limit - 1.0))).collect();
        let Some(mean) = Moments::of(&losses).mean() else { continue };
        let interval = t_interval(&losses, LEVEL).map(|estimate| (estimate.interval.low, estimate.interval.high));
        points.push(Point::new(f64::from(*spp), mean).with_y(interval));
        let prototype = PROTOTYPE.iter().find(|(of, _)| of == spp).map(|(_, bias)| *bias);
        worst = prototype.map_or(worst, |bias| worst.max((mean - bias).abs()));
        table.push(vec![
            spp.to_string(),
            losses.len().to_string(),
            format!("{mean:.2}"),
            interval.map_or_else(|| "none".to_string(), |(low, high)| format!("{low:.2} to {high:.2}")),
            prototype.map_or_else(|| "-".to_string(), |bias| format!("{bias:.1}")),
            format!("{:.2}", 100.0 * ((1.0 + mean / 100.0) * limit / truth - 1.0)),
        ]);
    }
    let ticks: Vec<f64> = points.iter().map(|point| point.x).collect();
    let prototype = PROTOTYPE.iter().map(|&(spp, bias)| Point::new(f64::from(spp), bias)).collect();
    let mut chart = LineChart::new(
        "Light lost by clamping each subpixel before averaging",
        Axis::log("samples per pixel").ticks_at(ticks),
        Axis::linear("mean radiance against the clamped limit, %").including([0.0]),
        vec![
            Series::new("measured here", Look::nth(0), points),
            Series::new("prototype, 256x192", Look::nth(1), prototype).scattered(),
        ],
    );
    chart.dodge = 8.0;
    chart.subtitle = results.workload();
    chart.caption = format!("Bars: 95 % interval over seeds. The limit is the clamped image at {largest} spp.");
    let finding = format!(
        "Clamped, the image converges to a mean radiance of {limit:.4} instead of {truth:.4}: {:.1} % of the light is above what a display shows and goes for good. On the way there the clamp takes \
         more, and how much depends on the samples; what was measured here is within {worst:.1} points of the prototype at every number of samples. Images with different samples per pixel so \
         do not estimate the same picture, and errors against a clamped reference do not fall along a line.",
        100.0 * (1.0 - limit / truth)
    );
    let columns = [
        "spp",
        "seeds",
        "bias against the clamped limit, %",
        "95 % interval",
        "prototype, %",
        "bias against the true light, %",
    ];
    let title = "Bias of the subpixel clamp".to_string();
    let mut found = vec![
        Block::Figure { stem: "clamp-bias", figure: Box::new(chart) },
        Block::Finding(finding),
        Block::Table {
            stem: "clamp-bias",
            table: Table { title, columns: columns.map(String::from).to_vec(), rows: table },
        },
    ];
    found.extend(recursion(&by_spp, truth));
    Ok(found)
}

/// What clamping every recursion loses, by samples.
fn recursion(by_spp: &BTreeMap<(String, u32), Vec<&Record>>, truth: f64) -> Option<Block> {
    let losses: Vec<(u32, f64)> = by_spp
        .iter()
        .filter(|((clamp, _), _)| clamp == "recursion")
        .filter_map(|((_, spp), records)| {
            let values: Vec<f64> = records.iter().filter_map(|row| row.mean_radiance).collect();
            Some((*spp, 100.0 * (1.0 - Moments::of(&values).mean()? / truth)))
        })
        .collect();
    let (first, last) = (losses.first()?, losses.last()?);
    Some(Block::Finding(format!(
        "Clamped at every recursion, as report B does, the image loses {:.1} % of the light at {} spp and {:.1} % at {}: every path is cut by itself, so no number of samples brings it back.",
        first.1, first.0, last.1, last.0
    )))
}
