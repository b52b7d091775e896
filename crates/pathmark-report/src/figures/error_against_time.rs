//! The cost of accuracy by estimator and sampler: error against seconds, a line for each, with a band for its interval
//! over seeds.

use super::pairs::soonest;
use crate::contenders::{Contender, CostPoint, contenders};
use crate::plot::number::short;
use crate::prelude::*;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let scenes = contenders(results)?;
    let Some((scene, first)) = scenes.iter().next() else {
        let text = "There is no error against time: it takes errors against references from two seeds or more.";
        return Ok(vec![Block::notice(text)]);
    };
    let point = |point: &CostPoint| Estimated::of(point.rmse, point.interval).above(point.seconds);
    let series = |(index, contender): (usize, &Contender)| {
        Series::new(&contender.name, Look::nth(index), contender.points.iter().map(point).collect()).banded()
    };
    let mut chart = LineChart::new(
        Title::new("What accuracy costs in time, by estimator and sampler").with_result(result(first)),
        Axis::log("seconds of rendering"),
        Axis::log("RMSE, linear radiance"),
        first.iter().enumerate().map(series).collect(),
    );
    chart.subtitle = format!("{scene}, {}, {}", results.size(), results.run.machine.line());
    chart.caption =
        "Bands: 95 % interval over seeds. Along a line the samples per pixel double from point to point. Grey: slope -1/2."
            .to_string();
    let start = first.first().and_then(|contender| contender.points.first()).map(|point| (point.seconds, point.rmse));
    if let Some(curve) = start.and_then(|start| Curve::power_through(start, -0.5)) {
        chart.overlays.push(Overlay::guide("slope -1/2", curve));
    }
    let points = scenes.values().flatten().flat_map(|contender| contender.points.iter().map(move |p| (contender, p)));
    let table = Block::table("error-against-time", "Error and time along each curve", points)
        .column("scene", |(contender, _)| contender.image.scene.clone())
        .column("estimator + sampler", |(contender, _)| contender.name.clone())
        .column("spp", |(_, point)| point.spp.to_string())
        .number("seconds", Decimals(4), |(_, point)| point.seconds)
        .estimated("RMSE", Decimals(5), |(_, point)| Estimated::of(point.rmse, point.interval))
        .number("variation over seeds", Decimals(3), |(_, point)| point.variation)
        .end();
    Ok(vec![Block::figure("error-against-time", chart), table])
}

/// The result in a line: the contender that reaches the least common error soonest, beside the first one.
fn result(contenders: &[Contender]) -> Option<String> {
    let first = contenders.first()?;
    let (place, best, ratio) = soonest(contenders)?;
    let rmse = short(place.rmse, 2);
    let interval = ratio.interval;
    Some(match (interval.low > 1.0, interval.high < 1.0) {
        (true, _) => {
            format!("{} is {} times as fast as {} to an RMSE of {rmse}", best.name, titles::told(ratio)?, first.name)
        }
        (_, true) => format!("{} reaches an RMSE of {rmse} sooner than {}, the next", first.name, best.name),
        _ => format!("This machine cannot tell what reaches an RMSE of {rmse} first"),
    })
}
