//! The best estimator for each scene: seconds to the same error, relative to the estimator that is named first.

use crate::analysis::price::equal_error;
use crate::contenders::{Contender, contenders};
use crate::prelude::*;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let scenes = contenders(results)?;
    let estimators = results.definition.estimator_names();
    let Some((first, others)) = estimators.split_first() else { return Ok(Vec::new()) };
    let dot = |contenders: &[Contender], other: &str| {
        let of = |name: &str| contenders.iter().find(|contender| contender.image.estimator == name);
        let (yardstick, other) = (of(first)?, of(other)?);
        let goal = [yardstick, other].iter().filter_map(|c| Some(c.points.last()?.rmse)).reduce(f64::max)?;
        Some(Estimated::from(equal_error(&yardstick.renderer, &other.renderer, goal)?).dot())
    };
    let rows: Vec<DotRow> = scenes
        .iter()
        .map(|(scene, contenders)| DotRow::new(scene, others.iter().map(|other| dot(contenders, other)).collect()))
        .collect();
    if rows.iter().all(|row| row.dots.iter().all(Option::is_none)) {
        return Ok(vec![Block::notice("No two estimators were measured on the same scene.")]);
    }
    let found: Vec<String> = rows
        .iter()
        .filter_map(|row| {
            let best = row.dots.iter().zip(others).filter_map(|(dot, name)| Some((dot.as_ref()?, name)));
            let (dot, name) = best.max_by(|a, b| a.0.value.total_cmp(&b.0.value))?;
            let (low, high) = dot.interval?;
            let found = format!("{name} {:.2} ({low:.2} to {high:.2})", dot.value);
            Some(match (low > 1.0, high < 1.0) {
                (true, _) => format!("{}: {found}", row.name),
                (_, true) => format!("{}: {first}, beside {found}", row.name),
                _ => format!("{}: {first} or {found}, not told apart", row.name),
            })
        })
        .collect();
    let plot = DotPlot::new(
        format!("How many times as fast as {first} to the same error"),
        Axis::log(format!("seconds of {first} / seconds")).including([1.0]),
        rows,
    );
    let mut plot = plot.grouped(others);
    plot.guides = vec![(1.0, format!("as fast as {first}"))];
    plot.subtitle = results.run.machine.line();
    plot.caption = "Bars: 95 % interval over seeds, of error and time together.".to_string();
    Ok(vec![
        Block::figure("estimators", plot),
        Block::finding(format!("The best estimator of each scene, in times as fast as {first}. {}.", found.join("; "))),
    ])
}
