//! Report B's microfacet material: directions by the cosine against directions by the facets that are seen, at equal samples.
//!
//! Scenes whose names differ in the ending `-vndf` alone are the same image with other directions.

use crate::analysis::Interval;
use crate::analysis::quantile::median;
use crate::error::Result;
use crate::image_io::tone_map::quantise_image;
use crate::measure::Record;
use crate::plot::dot_plot::{Dot, DotPlot, Group, Row};
use crate::plot::style::Look;
use crate::plot::{Axis, Cell, ContactSheet};
use crate::report::block::{Block, Table};
use crate::report::reference_image::reference_image;
use crate::report::results::{Results, confidence, median_with_interval, with_level};
use std::collections::BTreeMap;

/// What ends the name of a scene whose directions follow the facets.
const BY_FACETS: &str = "-vndf";

/// A median of ratios, facets over cosine.
type Ratio = (f64, Option<Interval>);

/// One scene both ways.
struct Pair<'a> {
    scene: &'a str,
    error: Ratio,
    time: Ratio,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let mut scenes: Vec<&str> = Vec::new();
    for record in &results.records {
        let scene = record.scene.strip_suffix(BY_FACETS).unwrap_or(&record.scene);
        if !scenes.contains(&scene) {
            scenes.push(scene);
        }
    }
    scenes.sort_by_key(|scene| (scene.len(), *scene));
    let pairs: Vec<Pair<'_>> = scenes.iter().filter_map(|scene| pair(results, scene)).collect();
    let mut blocks: Vec<Block> = sheet(results, &scenes)?.into_iter().collect();
    if !pairs.is_empty() {
        blocks.push(Block::Figure { stem: "roughness", figure: Box::new(plot(results, &pairs)) });
        blocks.extend(pairs.iter().map(finding));
    }
    blocks.push(Block::Table { stem: "roughness-table", table: table(results, &scenes) });
    Ok(blocks)
}

/// A value of each run of a scene.
fn values(results: &Results, scene: &str, value: fn(&Record) -> Option<f64>) -> BTreeMap<(u64, u32), f64> {
    let records = results.records.iter().filter(|record| record.scene == scene);
    records.filter_map(|record| Some(((record.seed, record.repetition), value(record)?))).collect()
}

/// The median over seeds of a value by the facets over the same by the cosine.
fn ratio(results: &Results, scene: &str, value: fn(&Record) -> Option<f64>) -> Option<Ratio> {
    let cosine = values(results, scene, value);
    let facets = values(results, &format!("{scene}{BY_FACETS}"), value);
    let ratios: Vec<f64> = cosine.iter().filter_map(|(run, cosine)| Some(facets.get(run)? / cosine)).collect();
    median_with_interval(&ratios)
}

/// The squared error, which is the variance, as the cross form against two references gives it: free of their own noise.
fn variance(record: &Record) -> Option<f64> {
    record.mse.filter(|mse| *mse > 0.0)
}

fn pair<'a>(results: &Results, scene: &'a str) -> Option<Pair<'a>> {
    let error = ratio(results, scene, variance)?;
    Some(Pair { scene, error, time: ratio(results, scene, |record| record.makespan_s)? })
}

fn plot(results: &Results, pairs: &[Pair<'_>]) -> DotPlot {
    let dot = |(value, interval): Ratio| Some(Dot { value, interval: interval.map(|i| (i.low, i.high)) });
    let rows =
        pairs.iter().map(|pair| Row { name: pair.scene.to_string(), dots: vec![dot(pair.error), dot(pair.time)] });
    let axis = Axis::log("by facets / by cosine, at equal samples").including([0.9, 1.1]);
    let mut plot = DotPlot::new("Directions by the facets against directions by the cosine", axis, rows.collect());
    let names = ["variance of the image", "time"];
    let group = |(index, name): (usize, &str)| Group { name: name.to_string(), look: Look::nth(index) };
    plot.groups = names.into_iter().enumerate().map(group).collect();
    plot.guides = vec![(1.0, "the same".to_string())];
    plot.subtitle = results.machine_line();
    let intervals: Vec<Interval> = pairs.iter().flat_map(|pair| [pair.error.1, pair.time.1]).flatten().collect();
    plot.caption = format!("Median of ratios of runs with the same seed. Bars: {}.", confidence(&intervals));
    plot
}

fn finding(pair: &Pair<'_>) -> Block {
    let told = |interval: Option<Interval>| interval.map_or_else(|| "no interval".to_string(), |i| with_level(&i, 2));
    let (variance, time) = (pair.error, pair.time);
    let verdict = match variance.1 {
        Some(interval) if interval.high < 1.0 => "the facets are the better guide",
        Some(interval) if interval.low > 1.0 => "the cosine is the better guide",
        _ => "these runs do not tell the two apart",
    };
    Block::Finding(format!(
        "{}: at equal samples directions by the facets leave {:.2} times the variance, {}, in {:.2} times the time, {}: {verdict}.",
        pair.scene,
        variance.0,
        told(variance.1),
        time.0,
        told(time.1),
    ))
}

fn table(results: &Results, scenes: &[&str]) -> Table {
    let mut rows = Vec::new();
    for (scene, directions) in scenes.iter().flat_map(|scene| [(scene, "cosine"), (scene, "facets")]) {
        let name = if directions == "cosine" { (*scene).to_string() } else { format!("{scene}{BY_FACETS}") };
        let records: Vec<&Record> = results.records.iter().filter(|record| record.scene == name).collect();
        let typical = |value: &dyn Fn(&Record) -> Option<f64>| {
            median(&records.iter().filter_map(|record| value(record)).collect::<Vec<f64>>())
        };
        let Some(time) = typical(&|record| Some(record.makespan_s? / record.paths? as f64 * 1e9)) else { continue };
        let error = typical(&variance);
        // Monte Carlo efficiency: 1/(variance x time), the time that of a sample, in microseconds.
        let efficiency = error.map(|variance| 1.0 / (variance * time * 1e-3));
        let number = |value: Option<f64>, digits: usize| {
            value.map_or_else(|| "-".to_string(), |value| format!("{value:.digits$}"))
        };
        // A mirror has one direction, however one looks for it.
        let is_compared = results.records.iter().any(|record| record.scene.strip_suffix(BY_FACETS) == Some(*scene));
        rows.push(vec![
            (*scene).to_string(),
            if is_compared { directions } else { "the mirror's" }.to_string(),
            records.len().to_string(),
            number(error.map(f64::sqrt), 4),
            format!("{time:.0}"),
            number(efficiency, 3),
        ]);
    }
    let columns = ["scene", "directions", "runs", "RMSE, linear", "ns a sample", "1 / (variance x us a sample)"];
    Table { title: "Roughness: medians over seeds".to_string(), columns: columns.map(String::from).to_vec(), rows }
}

/// The references, on which the material can be seen; the renders themselves are too short for that.
fn sheet(results: &Results, scenes: &[&str]) -> Result<Option<Block>> {
    let mut cells = Vec::new();
    for scene in scenes {
        let Some(image) = reference_image(results, Some(scene))? else { return Ok(None) };
        let caption = vec![(*scene).to_string(), "reference".to_string()];
        cells.push(Some(Cell { caption, width: image.width, height: image.height, rgb: quantise_image(&image)? }));
    }
    let title = "Report B's material by roughness".to_string();
    let sheet = ContactSheet { title: title.clone(), subtitle: results.machine_line(), rows: vec![cells], bar: None };
    Ok(Some(Block::Picture { stem: "roughness-images", title, png: sheet.png()? }))
}
