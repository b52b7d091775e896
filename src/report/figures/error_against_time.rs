//! What accuracy costs with each estimator and sampler: error against seconds, a line for each, a band for its interval over seeds.

use crate::error::Result;
use crate::plot::style::Look;
use crate::plot::{Axis, Curve, LineChart, Overlay, Point, Series};
use crate::report::block::{Block, Table};
use crate::report::contenders::{Contender, contenders};
use crate::report::results::Results;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let scenes = contenders(results);
    let Some((scene, first)) = scenes.iter().next() else {
        let text = "There is no error against time: it takes errors against references from two seeds or more.";
        return Ok(vec![Block::Finding(text.to_string())]);
    };
    let mut chart = LineChart::new(
        "What accuracy costs in time, by estimator and sampler",
        Axis::log("seconds of rendering"),
        Axis::log("RMSE, linear radiance"),
        first.iter().enumerate().map(|(index, contender)| series(index, contender)).collect(),
    );
    let size = results.records.first().map_or_else(String::new, |row| format!("{}x{}", row.width, row.height));
    chart.subtitle = format!("{scene}, {size}, {}", results.machine_line());
    chart.caption =
        "Bands: 95 % interval over seeds. Along a line the samples per pixel double from point to point.".to_string();
    let start = first.first().and_then(|contender| contender.points.first()).map(|point| (point.seconds, point.rmse));
    if let Some(curve) = start.and_then(|start| Curve::power_through(start, -0.5)) {
        chart.overlays.push(Overlay::guide("slope -1/2", curve));
    }
    let rows = scenes.values().flatten().flat_map(rows).collect();
    let columns = ["scene", "estimator + sampler", "spp", "seconds", "RMSE", "95 % interval", "variation over seeds"];
    let title = "Error and time along each curve".to_string();
    let table = Table { title, columns: columns.map(String::from).to_vec(), rows };
    Ok(vec![
        Block::Figure { stem: "error-against-time", figure: Box::new(chart) },
        Block::Table { stem: "error-against-time", table },
    ])
}

fn series(index: usize, contender: &Contender) -> Series {
    let point = |point: &crate::report::contenders::CostPoint| {
        let interval = point.interval.map(|interval| (interval.low, interval.high));
        Point::new(point.seconds, point.rmse).with_y(interval)
    };
    Series::new(&contender.name, Look::nth(index), contender.points.iter().map(point).collect()).banded()
}

fn rows(contender: &Contender) -> impl Iterator<Item = Vec<String>> + '_ {
    contender.points.iter().map(|point| {
        vec![
            contender.scene.clone(),
            contender.name.clone(),
            point.spp.to_string(),
            format!("{:.4}", point.seconds),
            format!("{:.5}", point.rmse),
            point.interval.map_or_else(|| "none".to_string(), |i| format!("{:.5} to {:.5}", i.low, i.high)),
            point.variation.map_or_else(|| "-".to_string(), |variation| format!("{variation:.3}")),
        ]
    })
}
