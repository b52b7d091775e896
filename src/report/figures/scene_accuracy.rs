//! Error by scene at the same samples per pixel: report A's claim that scenes without reflections are more accurate, and the control that
//! exchanges the materials of one scene.

use crate::analysis::mean::t_interval;
use crate::analysis::mse::over_seeds;
use crate::analysis::quantile::median;
use crate::analysis::rank::spearman;
use crate::analysis::{Estimate, Interval};
use crate::error::Result;
use crate::measure::Record;
use crate::plot::style::{Look, MARKERS, SERIES};
use crate::plot::{Axis, LineChart, Point, Series};
use crate::report::block::{Block, Table};
use crate::report::results::{LEVEL, Results};
use std::collections::BTreeMap;

/// The same box with matt balls, with a mirror and a glass ball, and with two mirror balls.
const CONTROL: [&str; 3] = ["cornell-diffuse", "cornell", "cornell-mirror"];

/// Error at which prices are compared: a hundredth of the mean radiance.
const GOAL: f64 = 0.01;

/// What is known of a scene.
struct Accuracy {
    scene: String,
    spp: u32,
    /// Mean radiance over all pixels and channels, and all seeds.
    radiance: f64,
    /// Relative RMSE of each seed.
    by_seed: BTreeMap<u64, f64>,
    /// Root of the mean of their squares, with its interval.
    error: f64,
    interval: Option<Interval>,
    rays: f64,
    /// Processor seconds of a sample.
    sample_s: f64,
    pixels: f64,
}

impl Accuracy {
    /// Processor seconds until the image has an error of [`GOAL`]: the error falls with the root of the samples.
    fn price_s(&self) -> f64 {
        let spp = f64::from(self.spp) * (self.error / GOAL) * (self.error / GOAL);
        spp * self.pixels * self.sample_s
    }
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let mut scenes = accuracies(results)?;
    if scenes.is_empty() {
        let text = "There is no accuracy by scene: it takes errors against references, and the kept images.";
        return Ok(vec![Block::Finding(text.to_string())]);
    }
    scenes.sort_by(|a, b| a.error.total_cmp(&b.error));
    let mut blocks = vec![Block::Figure { stem: "scene-accuracy", figure: Box::new(chart(results, &scenes)) }];
    blocks.extend(claim(&scenes));
    blocks.extend(control(&scenes));
    blocks.push(Block::Table { stem: "scene-accuracy-table", table: table(&scenes) });
    Ok(blocks)
}

fn accuracies(results: &Results) -> Result<Vec<Accuracy>> {
    let mut radiances: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for (record, image) in results.kept_images(|record| record.mse.is_some())? {
        let channels = image.pixels.iter().flatten().copied();
        let mean = channels.sum::<f64>() / (3 * image.pixels.len()) as f64;
        radiances.entry(&record.scene).or_default().push(mean);
    }
    let of_scene = |(scene, records): (String, Vec<&Record>)| {
        let images = radiances.get(scene.as_str())?;
        let radiance = images.iter().sum::<f64>() / images.len() as f64;
        let first = *records.first()?;
        let mse: BTreeMap<u64, f64> =
            records.iter().filter_map(|record| Some((record.seed, record.mse? / (radiance * radiance)))).collect();
        let squares: Vec<f64> = mse.values().copied().collect();
        let error = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        let median_of = |value: fn(&Record) -> Option<f64>| {
            median(&records.iter().filter_map(|record| value(record)).collect::<Vec<f64>>())
        };
        let accuracy = Accuracy {
            spp: first.spp,
            radiance,
            by_seed: mse.into_iter().map(|(seed, mse)| (seed, mse.sqrt())).collect(),
            error,
            interval: over_seeds(&squares, LEVEL).map(|error| error.rmse.interval),
            rays: median_of(|record| Some(record.rays? as f64 / record.paths? as f64))?,
            sample_s: median_of(|record| Some(record.cpu_s()? / record.paths? as f64))?,
            pixels: f64::from(first.width) * f64::from(first.height),
            scene,
        };
        accuracy.error.is_finite().then_some(accuracy)
    };
    Ok(results.by(|record| record.scene.clone()).into_iter().filter_map(of_scene).collect())
}

fn chart(results: &Results, scenes: &[Accuracy]) -> LineChart {
    let series = scenes.iter().enumerate().map(|(index, scene)| {
        let bar = scene.interval.map(|interval| (interval.low, interval.high));
        Series::new(&scene.scene, look(index), vec![Point::new(scene.rays, scene.error).with_y(bar)]).scattered()
    });
    let mut chart = LineChart::new(
        "Error and path length by scene",
        Axis::log("rays per sample"),
        Axis::log("RMSE / mean radiance"),
        series.collect(),
    );
    let first = results.records.first();
    chart.subtitle = first.map_or_else(String::new, |r| {
        format!("{}x{}, {} samples per pixel, {}", r.width, r.height, r.spp, r.estimator)
    });
    chart.caption =
        "Bars: 95 % interval over seeds. The legend goes from the smallest error to the largest.".to_string();
    chart
}

/// Colour and marker of a single point, which has no dashes to tell it from the one eight places before it.
fn look(index: usize) -> Look {
    Look { marker: MARKERS[(index + 3 * (index / SERIES.len())) % MARKERS.len()], ..Look::nth(index) }
}

/// Over scenes that differ in everything; the two variants of the control would count one scene three times.
fn claim(scenes: &[Accuracy]) -> Option<Block> {
    let others: Vec<&Accuracy> =
        scenes.iter().filter(|scene| scene.scene == CONTROL[1] || !CONTROL.contains(&scene.scene.as_str())).collect();
    let pairs: Vec<(f64, f64)> = others.iter().map(|scene| (scene.rays, scene.error)).collect();
    let found = spearman(&pairs)?;
    let verdict = match (found.p < 1.0 - LEVEL, found.rho > 0.0) {
        (true, true) => "longer paths and larger errors go together",
        (true, false) => "scenes with longer paths even have the smaller errors",
        (false, _) => "so many scenes show no connection between path length and error",
    };
    Some(Block::Finding(format!(
        "Report A says that a scene without reflections is more accurate because its paths bounce less. Over {} different scenes the rank correlation of rays per sample and \
         relative error is {:.2} (p = {:.2}): {verdict}.",
        others.len(),
        found.rho,
        found.p,
    )))
}

/// The error of one scene over that of another, paired by seed: the mean of logarithms.
fn error_ratio(above: &Accuracy, below: &Accuracy) -> Option<Estimate> {
    let pairs = above.by_seed.iter().filter_map(|(seed, error)| Some(libm::log(error / below.by_seed.get(seed)?)));
    let found = t_interval(&pairs.collect::<Vec<f64>>(), LEVEL)?;
    let Interval { low, high, level } = found.interval;
    let interval = Interval::between(libm::exp(low), libm::exp(high), level)?;
    Some(Estimate { value: libm::exp(found.value), interval })
}

fn control(scenes: &[Accuracy]) -> Option<Block> {
    let of = |name: &str| scenes.iter().find(|scene| scene.scene == name);
    let (matt, own, mirrors) = (of(CONTROL[0])?, of(CONTROL[1])?, of(CONTROL[2])?);
    let (glass, mirror) = (error_ratio(own, matt)?, error_ratio(mirrors, matt)?);
    let ratio = |found: &Estimate| {
        format!("{:.2} times ({:.2} to {:.2})", found.value, found.interval.low, found.interval.high)
    };
    let verdict = match (glass.interval.low > 1.0, mirror.interval.low > 1.0) {
        (true, true) => "Reflections do cost accuracy in this box",
        (false, false) => "Reflections as such cost this box no accuracy",
        (true, false) => "Glass costs this box accuracy, mirrors do not",
        (false, true) => "Mirrors cost this box accuracy, a mirror and a glass ball together do not",
    };
    let length = |scene: &Accuracy| format!("{:.2}", scene.rays);
    Some(Block::Finding(format!(
        "The control changes the balls of one box and nothing else. With a mirror and a glass ball its relative error is {} that with matt balls, with two mirror balls {}; \
         rays per sample are {} with matt balls, {} and {}. {verdict}.",
        ratio(&glass),
        ratio(&mirror),
        length(matt),
        length(own),
        length(mirrors),
    )))
}

fn table(scenes: &[Accuracy]) -> Table {
    let row = |scene: &Accuracy| {
        vec![
            scene.scene.clone(),
            format!("{:.4}", scene.radiance),
            format!("{:.4}", scene.error * scene.radiance),
            format!("{:.4}", scene.error),
            scene.interval.map_or_else(|| "none".to_string(), |i| format!("{:.4} to {:.4}", i.low, i.high)),
            scene.by_seed.len().to_string(),
            format!("{:.2}", scene.rays),
            format!("{:.0}", scene.sample_s * 1e9),
            format!("{:.4}", 1.0 / (f64::from(scene.spp) * scene.error * scene.error * scene.sample_s * 1e6)),
            format!("{:.2}", scene.price_s()),
        ]
    };
    let columns = [
        "scene",
        "mean radiance",
        "RMSE, linear",
        "RMSE / mean radiance",
        "95 % interval over seeds",
        "seeds",
        "rays per sample",
        "ns per sample",
        "efficiency, 1 / (relative variance of a sample x µs)",
        "processor seconds to 1 % error",
    ];
    let title = "Accuracy by scene, most accurate first".to_string();
    Table { title, columns: columns.map(String::from).to_vec(), rows: scenes.iter().map(row).collect() }
}
