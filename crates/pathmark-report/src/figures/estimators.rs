//! The best estimator for each scene: seconds to the same error, relative to the estimator that is named first.

use crate::analysis::price::equal_error;
use crate::contenders::{Contender, contenders};
use crate::prelude::*;
use crate::titles::Sides;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let scenes = contenders(results)?;
    let estimators = results.definition.estimator_names();
    let Some((first, others)) = estimators.split_first() else { return Ok(Vec::new()) };
    let ratio = |contenders: &[Contender], other: &str| {
        let of = |name: &str| contenders.iter().find(|contender| contender.image.estimator == name);
        let (yardstick, other) = (of(first)?, of(other)?);
        let goal = [yardstick, other].iter().filter_map(|c| Some(c.points.last()?.rmse)).reduce(f64::max)?;
        equal_error(&yardstick.renderer, &other.renderer, goal).map(Estimated::from)
    };
    let lines: Vec<(&str, Vec<Option<Estimated>>)> = scenes
        .iter()
        .map(|(scene, own)| (scene.as_str(), others.iter().map(|other| ratio(own, other)).collect()))
        .collect();
    let best = |(scene, ratios): &(&str, Vec<Option<Estimated>>)| {
        let own = ratios.iter().zip(others).filter_map(|(told, name)| Some((Ratio::of((*told)?)?, name.as_str())));
        let (ratio, estimator) = own.max_by(|a, b| a.0.value.total_cmp(&b.0.value))?;
        Some(Best { scene: (*scene).to_string(), estimator: estimator.to_string(), ratio })
    };
    let found: Vec<Best> = lines.iter().filter_map(best).collect();
    if found.is_empty() {
        return Ok(vec![Block::notice("No two estimators were measured on the same scene.")]);
    }
    let rows = lines
        .into_iter()
        .map(|(scene, told)| DotRow::new(scene, told.into_iter().map(|told| told.map(|told| told.dot())).collect()));
    let result = result(first, &found);
    let plot = DotPlot::new(
        Title::new(format!("How many times as fast as {first} to the same error")).with_result(Some(result.clone())),
        Axis::log(format!("seconds of {first} / seconds")).including([1.0]),
        rows.collect(),
    );
    let mut plot = plot.grouped(others);
    plot.guides = vec![(1.0, format!("as fast as {first}"))];
    plot.subtitle = results.run.machine.line();
    plot.caption = "Bars: 95 % interval over seeds, of error and time together.".to_string();
    let open = Sides::of(found.iter().map(|best| best.ratio)).open;
    let finding = format!("{result}. Not told apart: {}.", counted(open, "scene"));
    let table =
        Block::table("best-estimators", format!("The best other estimator of each scene beside {first}"), found)
            .column("scene", |best| best.scene.clone())
            .column("estimator", |best| best.estimator.clone())
            .estimated(format!("times as fast as {first}"), Decimals(2), |best| Estimated::from(best.ratio))
            .end();
    Ok(vec![Block::figure("estimators", plot), Block::finding(finding), table])
}

/// The fastest of the other estimators on a scene.
struct Best {
    scene: String,
    estimator: String,
    /// The seconds of the first estimator over its seconds.
    ratio: Ratio,
}

/// The result in a line.
fn result(first: &str, found: &[Best]) -> String {
    let sides = Sides::of(found.iter().map(|best| best.ratio));
    let scenes = counted(found.len(), "scene");
    match titles::largest_above_1(found.iter().map(|best| (best, best.ratio))) {
        Some((Best { scene, estimator, .. }, ratio)) => format!(
            "Another estimator than {first} is faster on {} of {scenes}, most of all {estimator} on {scene}: {:.1} times",
            sides.above, ratio.value
        ),
        None if sides.below == found.len() => format!("{first} is the fastest on all of {scenes}"),
        None => format!("This machine cannot tell whether another estimator than {first} is faster on any of {scenes}"),
    }
}
