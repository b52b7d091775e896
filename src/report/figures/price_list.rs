//! The price list: samples and seconds to each accuracy, and how well a part of the measurements predicts the rest.

use crate::analysis::Estimate;
use crate::error::Result;
use crate::plot::style::Look;
use crate::plot::{Axis, Dot, DotPlot, Group, Row};
use crate::report::block::{Block, Table};
use crate::report::contenders::{Check, Contender, contenders, missing};
use crate::report::results::Results;

/// The accuracies that are priced, in linear radiance.
const GOALS: [f64; 4] = [0.1, 0.05, 0.02, 0.01];

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let scenes = contenders(results);
    let all: Vec<&Contender> = scenes.values().flatten().collect();
    if all.is_empty() {
        let text = "There is no price list: it takes errors against references from two seeds or more.";
        return Ok(vec![Block::Finding(text.to_string())]);
    }
    let several = scenes.len() > 1;
    let name = |contender: &Contender| {
        if several { format!("{}: {}", contender.scene, contender.name) } else { contender.name.clone() }
    };
    let mut blocks = vec![Block::Figure { stem: "price-list", figure: Box::new(plot(results, &all, &name)) }];
    blocks.extend(missing(results));
    blocks.extend(checked(&all));
    let rows = all.iter().map(|contender| row(contender, name(contender))).collect();
    let goals = GOALS.iter().map(|goal| format!("seconds to an RMSE of {goal}"));
    let columns = ["", "variance of a sample", "s per sample and pixel", "efficiency, 1 / (variance x s)"];
    let columns = columns.into_iter().map(String::from).chain(goals).chain([
        "predicted for spp".to_string(),
        "RMSE, measured / predicted".to_string(),
        "seconds, measured / predicted".to_string(),
    ]);
    let title = "Price list, intervals of 95 %".to_string();
    blocks.push(Block::Table { stem: "price-list", table: Table { title, columns: columns.collect(), rows } });
    Ok(blocks)
}

fn plot(results: &Results, all: &[&Contender], name: &dyn Fn(&Contender) -> String) -> DotPlot {
    let dots = |contender: &&&Contender| {
        let dot = |goal: &f64| {
            let seconds = contender.renderer.price(*goal)?.seconds;
            Some(Dot { value: seconds.value, interval: Some((seconds.interval.low, seconds.interval.high)) })
        };
        GOALS.iter().map(dot).collect::<Vec<Option<Dot>>>()
    };
    let rows = all.iter().map(|contender| Row { name: name(contender), dots: dots(&contender) }).collect();
    let mut plot = DotPlot::new("What each accuracy costs", Axis::log("seconds of rendering"), rows);
    let group = |(index, goal): (usize, &f64)| Group { name: format!("RMSE {goal}"), look: Look::nth(index) };
    plot.groups = GOALS.iter().enumerate().map(group).collect();
    let size = results.records.first().map_or_else(String::new, |row| format!("{}x{}", row.width, row.height));
    plot.subtitle = format!("{size}, {}", results.machine_line());
    plot.caption =
        "Bars: 95 % interval of error and time together. Prices beyond the largest number of samples are extrapolated."
            .to_string();
    plot
}

fn row(contender: &Contender, name: String) -> Vec<String> {
    let renderer = &contender.renderer;
    let text = |estimate: Option<Estimate>| {
        estimate.map_or_else(
            || "-".to_string(),
            |e| format!("{} ({} to {})", short(e.value), short(e.interval.low), short(e.interval.high)),
        )
    };
    let per_spp = renderer.seconds_per_spp;
    let variance = renderer.efficiency().and_then(|efficiency| efficiency.times(&per_spp)).and_then(|e| e.inverse());
    let mut row = vec![
        name,
        variance.map_or_else(|| "-".to_string(), |variance| short(variance.value)),
        text(Some(per_spp)),
        text(renderer.efficiency()),
    ];
    row.extend(GOALS.iter().map(|goal| text(renderer.price(*goal).map(|price| price.seconds))));
    match contender.check() {
        Some(check) => {
            row.extend([check.spp.to_string(), format!("{:.3}", check.rmse), format!("{:.3}", check.seconds)]);
        }
        None => row.extend(["-".to_string(), "-".to_string(), "-".to_string()]),
    }
    row
}

/// Three significant digits.
fn short(value: f64) -> String {
    crate::plot::number::short(value, 3)
}

/// How far predictions are off at worst.
fn checked(all: &[&Contender]) -> Option<Block> {
    let checks: Vec<_> = all.iter().filter_map(|contender| Some((contender, contender.check()?))).collect();
    let worst = |of: &dyn Fn(&Check) -> f64| {
        let far = |(contender, check): &(&&Contender, Check)| (contender.name.clone(), 100.0 * (of(check) - 1.0));
        checks.iter().map(far).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    };
    let ((by_error, error), (by_time, time)) = (worst(&|check| check.rmse)?, worst(&|check| check.seconds)?);
    Some(Block::Finding(format!(
        "Half of the seeds, up to a quarter of the samples, predict RMSE and seconds of the other half at the end of its curves. At worst the RMSE came out {error:+.1} % ({by_error}) and the \
         seconds {time:+.1} % ({by_time}) of what was predicted. Half of an error costs four times the seconds with independent samples."
    )))
}
