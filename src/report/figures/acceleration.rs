//! What a hierarchy is worth: time per ray against the number of primitives, and the gain against samples per pixel.

use crate::analysis::quantile::median;
use crate::analysis::{Estimate, Interval};
use crate::error::Result;
use crate::measure::Record;
use crate::plot::style::Look;
use crate::plot::{Axis, LineChart, Point, Series};
use crate::report::block::{Block, Table};
use crate::report::results::{Results, confidence, median_with_interval, with_level};
use crate::scene::ACCELERATORS;

/// What the others are compared with.
const NONE: &str = "none";

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let mut blocks = Vec::new();
    blocks.extend(against_primitives(results));
    blocks.extend(crossover(results));
    blocks.extend(against_spp(results));
    blocks.push(table(results));
    Ok(blocks)
}

/// The number behind the name of a scene that is generated in many sizes.
fn primitives(record: &Record) -> Option<u64> {
    record.scene.split_once(':')?.1.parse().ok()
}

fn ns_per_ray(record: &Record) -> Option<f64> {
    Some(record.makespan_s? * 1e9 / record.rays? as f64)
}

/// Names and looks of the accelerators that were measured.
fn accelerators(results: &Results) -> impl Iterator<Item = (&'static str, Look)> {
    let measured = |name: &str| results.records.iter().any(|record| record.accelerator == name);
    let entries = ACCELERATORS.iter().enumerate().filter(move |(_, entry)| measured(entry.name));
    entries.map(|(index, entry)| (entry.name, Look::nth(index)))
}

fn against_primitives(results: &Results) -> Option<Block> {
    let mut intervals = Vec::new();
    let mut series = Vec::new();
    for (name, look) in accelerators(results) {
        let mut points = Vec::new();
        for (count, records) in results.by(primitives) {
            let of_name = records.iter().filter(|record| record.accelerator == name);
            let times: Vec<f64> = of_name.filter_map(|record| ns_per_ray(record)).collect();
            if let (Some(count), Some((median, interval))) = (count, median_with_interval(&times)) {
                intervals.extend(interval);
                let bar = interval.map(|interval| (interval.low, interval.high));
                points.push(Point::new(count as f64, median).with_y(bar));
            }
        }
        series.push(Series::new(name, look, points));
    }
    let mut chart = LineChart::new(
        "Time per ray against the number of spheres",
        Axis::log("spheres"),
        Axis::log("nanoseconds per ray"),
        series,
    );
    let counted = results.records.iter().find(|record| primitives(record).is_some())?;
    chart.subtitle = format!("balls filling the same share of a cube, {}", results.machine_line());
    chart.caption =
        format!("Median of repetitions of {}, shading and all. Bars: {}.", counted.estimator, confidence(&intervals));
    Some(Block::Figure { stem: "acceleration", figure: Box::new(chart) })
}

/// How many times as long a scene takes without a hierarchy as with that one.
fn gain(results: &Results, name: &str, is_wanted: impl Fn(&Record) -> bool) -> Option<Estimate> {
    let of = |name: &str| {
        let (name, is_wanted) = (name.to_string(), &is_wanted);
        move |record: &Record| record.accelerator == name && is_wanted(record)
    };
    results.kind_ratio(of(NONE), of(name))
}

/// From where on a hierarchy is faster, and by how much in the largest scene that was also rendered without.
fn crossover(results: &Results) -> Vec<Block> {
    let counts: Vec<u64> = results.by(primitives).into_keys().flatten().collect();
    let mut findings = Vec::new();
    for (name, _) in accelerators(results).filter(|(name, _)| *name != NONE) {
        let gains: Vec<(u64, Estimate)> = counts
            .iter()
            .filter_map(|count| Some((*count, gain(results, name, |record| primitives(record) == Some(*count))?)))
            .collect();
        let Some((most, largest)) = gains.last() else { continue };
        let slower = gains.iter().rev().find(|(_, gain)| gain.interval.low <= 1.0);
        let faster = gains.iter().find(|(count, _)| slower.is_none_or(|(slower, _)| count > slower));
        let from = match (slower, faster) {
            (None, Some((count, _))) => {
                format!("is faster than testing every sphere from the smallest number on, {count}")
            }
            (Some((slower, _)), Some((count, _))) => {
                format!(
                    "is faster than testing every sphere from {count} spheres on (the interval lies above 1), and at {slower} that is not certain"
                )
            }
            (_, None) => {
                "is at no number faster than testing every sphere by an interval that lies above 1".to_string()
            }
        };
        findings.push(Block::Finding(format!(
            "{name} {from}; at {most} spheres it is {:.1} times as fast, {}.",
            largest.value,
            with_level(&largest.interval, 1)
        )));
    }
    findings
}

/// The gain at each number of samples, in the scenes that are not generated. A factor that does not depend on it lies in every interval.
fn against_spp(results: &Results) -> Vec<Block> {
    let of_spp = |record: &Record| primitives(record).is_none().then_some(record.spp);
    let spps: Vec<u32> = results.by(of_spp).into_keys().flatten().collect();
    let (mut series, mut findings, mut intervals) = (Vec::new(), Vec::new(), Vec::<Interval>::new());
    for (name, look) in accelerators(results).filter(|(name, _)| *name != NONE) {
        let gains: Vec<(u32, Estimate)> = spps
            .iter()
            .filter_map(|spp| Some((*spp, gain(results, name, |record| of_spp(record) == Some(*spp))?)))
            .collect();
        let point = |(spp, gain): &(u32, Estimate)| {
            Point::new(f64::from(*spp), gain.value).with_y(Some((gain.interval.low, gain.interval.high)))
        };
        series.push(Series::new(name, look, gains.iter().map(point).collect()));
        intervals.extend(gains.iter().map(|(_, gain)| gain.interval));
        let low = gains.iter().map(|(_, gain)| gain.interval.low).fold(0.0, f64::max);
        let high = gains.iter().map(|(_, gain)| gain.interval.high).fold(f64::INFINITY, f64::min);
        let listed: Vec<String> = gains.iter().map(|(spp, gain)| format!("{:.2} at {spp}", gain.value)).collect();
        let verdict = if low <= high {
            format!("factors from {low:.2} to {high:.2} lie in every interval, so no dependence on the samples is seen")
        } else {
            "no factor lies in every interval".to_string()
        };
        if !gains.is_empty() {
            findings.push(Block::Finding(format!(
                "Times without a hierarchy over times with {name}, by samples per pixel: {}; {verdict}.",
                listed.join(", ")
            )));
        }
    }
    if findings.is_empty() {
        return findings;
    }
    let mut chart = LineChart::new(
        "Gain of a hierarchy against samples per pixel",
        Axis::log("samples per pixel").ticks_at(spps.iter().copied().map(f64::from)),
        Axis::linear("time without / time with").including([1.0]),
        series,
    );
    let scenes: Vec<String> =
        results.by(|record| primitives(record).is_none().then(|| record.scene.clone())).into_keys().flatten().collect();
    chart.subtitle = format!("{}, {}", scenes.join(", "), results.machine_line());
    chart.caption = format!("Median of ratios within a repetition. Bars: {}.", confidence(&intervals));
    chart.dodge = 4.0;
    let mut blocks = vec![Block::Figure { stem: "acceleration-spp", figure: Box::new(chart) }];
    blocks.append(&mut findings);
    blocks
}

fn table(results: &Results) -> Block {
    let place = |name: &str| ACCELERATORS.iter().position(|entry| entry.name == name);
    let kinds = results.by(|record| (primitives(record), record.scene.clone(), place(&record.accelerator)));
    let typical = |records: &[&Record], value: &dyn Fn(&Record) -> Option<f64>, digits: usize| {
        let values: Vec<f64> = records.iter().filter_map(|record| value(record)).collect();
        median(&values).map_or_else(|| "-".to_string(), |value| format!("{value:.digits$}"))
    };
    let rows = kinds.into_iter().map(|((_, scene, _), records)| {
        vec![
            scene,
            records.first().map_or_else(String::new, |record| record.accelerator.clone()),
            typical(&records, &ns_per_ray, 0),
            typical(&records, &|record| Some(record.box_tests? as f64 / record.rays? as f64), 1),
            typical(&records, &|record| Some(record.primitive_tests? as f64 / record.rays? as f64), 1),
            typical(&records, &|record| Some(record.build_s? * 1e3), 3),
        ]
    });
    let columns = ["scene", "accelerator", "ns per ray", "boxes per ray", "primitives per ray", "ms to build"];
    let title = "What rays are tested against: medians over repetitions".to_string();
    let table = Table { title, columns: columns.map(String::from).to_vec(), rows: rows.collect() };
    Block::Table { stem: "acceleration-table", table }
}
