//! When chance ends paths, and by what: efficiency against the vertex behind which it begins.

use crate::analysis::Estimate;
use crate::error::Result;
use crate::plot::style::Look;
use crate::plot::{Axis, LineChart, Point, Series};
use crate::report::block::{Block, Table};
use crate::report::contenders::{Contender, contenders};
use crate::report::results::Results;
use std::collections::BTreeMap;

/// smallpt's own rule, which the others are compared with.
const YARDSTICK: &str = "albedo:5";

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let scenes = contenders(results);
    let (mut lines, mut rows) = (BTreeMap::<String, Vec<Point>>::new(), Vec::new());
    let mut best: Option<(f64, String)> = None;
    for contender in scenes.values().flatten() {
        let same = |other: &&Contender| other.estimator == contender.estimator && other.roulette == YARDSTICK;
        let yardstick = scenes.get(&contender.scene).and_then(|others| others.iter().find(same));
        let Some(gain) = yardstick.and_then(|yardstick| gain(contender, yardstick)) else { continue };
        if best.as_ref().is_none_or(|(most, _)| gain.value > *most) {
            best = Some((gain.value, contender.name.clone()));
        }
        let line = |rule: &str| format!("{}, {}, by {rule}", contender.scene, contender.estimator);
        if let Some((rule, start)) = contender.roulette.split_once(':')
            && let Ok(start) = start.parse::<f64>()
        {
            let point = Point::new(start, gain.value).with_y(Some((gain.interval.low, gain.interval.high)));
            lines.entry(line(rule)).or_default().push(point);
        }
        rows.push(row(results, contender, &gain));
    }
    let Some((most, name)) = best else {
        let text = format!("There is no comparison of rules: it takes rows with {YARDSTICK}.");
        return Ok(vec![Block::Finding(text)]);
    };
    let series = lines.into_iter().enumerate().map(|(index, (name, mut points))| {
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        Series::new(name, Look::nth(index), points)
    });
    let mut chart = LineChart::new(
        "Efficiency by the start of Russian roulette",
        Axis::linear("vertices before roulette begins"),
        Axis::linear(format!("efficiency / that of {YARDSTICK}")).including([1.0]),
        series.collect(),
    );
    chart.subtitle = results.workload();
    chart.caption = "Efficiency: 1 / (variance of a sample x its seconds). Bars: 95 % interval over seeds.".to_string();
    chart.dodge = 6.0;
    let finding = format!("Of the rules that were tried, the most efficient is {name}: {most:.2} times {YARDSTICK}.");
    let columns = [
        "scene",
        "rule",
        "variance of a sample",
        "s per sample and pixel",
        "rays per sample",
        "efficiency",
        "95 % interval",
    ];
    let title = format!("Rules of roulette; efficiency is against {YARDSTICK}");
    Ok(vec![
        Block::Figure { stem: "roulette", figure: Box::new(chart) },
        Block::Finding(finding),
        Block::Table { stem: "roulette", table: Table { title, columns: columns.map(String::from).to_vec(), rows } },
    ])
}

/// Both of independent seeds' errors and times.
fn gain(contender: &Contender, yardstick: &Contender) -> Option<Estimate> {
    contender.renderer.efficiency()?.times(&yardstick.renderer.efficiency()?.inverse()?)
}

fn row(results: &Results, contender: &Contender, gain: &Estimate) -> Vec<String> {
    let renderer = &contender.renderer;
    let variance = renderer.curves.whole().last().map_or(f64::NAN, |(spp, mse)| spp * mse);
    let own = results.records.iter().filter(|row| {
        row.scene == contender.scene && row.estimator == contender.estimator && row.roulette == contender.roulette
    });
    let (rays, paths) = own
        .filter_map(|row| Some((row.rays? as f64, row.paths? as f64)))
        .fold((0.0, 0.0), |sum, row| (sum.0 + row.0, sum.1 + row.1));
    vec![
        contender.scene.clone(),
        format!("{} {}", contender.estimator, contender.roulette),
        format!("{variance:.4}"),
        format!("{:.6}", renderer.seconds_per_spp.value),
        format!("{:.2}", rays / paths),
        format!("{:.3}", gain.value),
        format!("{:.3} to {:.3}", gain.interval.low, gain.interval.high),
    ]
}
