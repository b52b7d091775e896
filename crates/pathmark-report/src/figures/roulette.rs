//! Rules of Russian roulette: efficiency against the vertex after which it begins.

use crate::contenders::{Contender, contenders};
use crate::prelude::*;
use std::cmp::Ordering;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let yardstick = yardstick(results, "roulette", "albedo:5")?;
    let scenes = contenders(results)?;
    let compared = scenes.values().flat_map(|contenders| {
        contenders.iter().filter_map(|contender| {
            let image = ImageKey { roulette: yardstick.clone(), ..contender.image.clone() };
            let same = |other: &&Contender| other.image == image && other.schedule == contender.schedule;
            let other = contenders.iter().find(same)?;
            // The yardstick's ratio to itself is exactly 1.
            let gain = if std::ptr::eq(contender, other) {
                Estimated::of(1.0, None)
            } else {
                Estimated::from(gain(contender, other)?)
            };
            Some((contender, gain))
        })
    });
    let mut compared: Vec<(&Contender, Estimated)> = compared.collect();
    compared.sort_by(|(a, _), (b, _)| place(a).partial_cmp(&place(b)).unwrap_or(Ordering::Equal));
    // Of equal gains, the first counts.
    let Some((best, most)) = compared.iter().rev().max_by(|a, b| a.1.value.total_cmp(&b.1.value)).copied() else {
        let text = format!("There is no comparison of rules: it takes rows with {yardstick}.");
        return Ok(vec![Block::notice(text)]);
    };
    let lines = gathered(compared.iter().filter_map(|(contender, gain)| {
        // A rule with a constant probability begins at the first vertex; its number is not a vertex.
        let (rule, start) = contender.image.roulette.split_once(':').filter(|(rule, _)| *rule != "constant")?;
        let name = format!("{}, {}, by {rule}", contender.image.scene, contender.image.estimator);
        Some((name, gain.above(start.parse().ok()?)))
    }));
    let starts: Vec<f64> = lines.values().flatten().map(|point: &Point| point.x).collect();
    let better = compared.iter().filter_map(|(contender, gain)| Some((*contender, Ratio::of(*gain)?)));
    let result = match titles::largest_above_1(better) {
        Some((best, ratio)) => {
            titles::told(ratio).map(|times| format!("{} is {times} times as efficient as {yardstick}", best.name))
        }
        None => Some(format!("No rule is more efficient than {yardstick} beyond the noise")),
    };
    let mut chart = LineChart::new(
        Title::new("Efficiency by the start of Russian roulette").with_result(result),
        Axis::linear("vertices before roulette begins").ticks_at(starts),
        Axis::linear(format!("efficiency / that of {yardstick}")).including([1.0]),
        Series::by_name(lines),
    );
    chart.subtitle = results.workload();
    chart.caption = "Efficiency: 1 / (variance of a sample x its seconds). Bars: 95 % interval over seeds.".to_string();
    chart.dodge = 6.0;
    let finding = match most.interval {
        Some(interval) if interval.low <= 1.0 => format!(
            "Of the rules that were tried, none is more efficient than {yardstick} beyond the noise. The highest efficiency is that of {}: {:.2} times {yardstick}, {}.",
            best.name,
            most.value,
            with_level(&interval, 2)
        ),
        Some(interval) => format!(
            "Of the rules that were tried, {} is the most efficient: {:.2} times {yardstick}, {}.",
            best.name,
            most.value,
            with_level(&interval, 2)
        ),
        None => format!("Of the rules that were tried, none was more efficient than {yardstick}."),
    };
    // Totals over all schedules of the image.
    let totals = results.by(|row| (&row.scene, &row.estimator, &row.roulette));
    let rays = |contender: &Contender| {
        let image = &contender.image;
        let rows = totals.get(&(&image.scene, &image.estimator, &image.roulette));
        let counts = rows.into_iter().flatten().filter_map(|row| Some((row.rays? as f64, row.samples? as f64)));
        let (rays, paths) = counts.fold((0.0, 0.0), |sum, row| (sum.0 + row.0, sum.1 + row.1));
        rays / paths
    };
    let title = format!("Rules of roulette; efficiency is against {yardstick}");
    let table = Block::table("roulette", title, &compared)
        .column("scene", |(contender, _)| contender.image.scene.clone())
        .column("rule", |(contender, _)| format!("{} {}", contender.image.estimator, contender.image.roulette))
        .number("variance of a sample", Decimals(4), |(contender, _)| contender.variance().unwrap_or(f64::NAN))
        .number("s per sample and pixel", Decimals(6), |(contender, _)| contender.renderer.seconds_per_spp.value)
        .number("rays per sample", Decimals(2), |(contender, _)| rays(contender))
        .estimated("efficiency", Decimals(3), |(_, gain)| *gain)
        .end();
    Ok(vec![Block::figure("roulette", chart), Block::finding(finding), table])
}

/// A sort key: scene, estimator, rule, and the start as a number, so that 2 comes before 10.
fn place(contender: &Contender) -> (&str, &str, &str, f64) {
    let image = &contender.image;
    let (rule, start) = image.roulette.split_once(':').unwrap_or((&image.roulette, ""));
    (&image.scene, &image.estimator, rule, start.parse().unwrap_or(0.0))
}

/// The ratio of two efficiencies, each from the errors and times of independent seeds.
fn gain(contender: &Contender, yardstick: &Contender) -> Option<Estimate> {
    contender.renderer.efficiency()?.times(&yardstick.renderer.efficiency()?.inverse()?)
}
