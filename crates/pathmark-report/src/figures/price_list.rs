//! The price list: samples and seconds to each accuracy, and predictions of later points from earlier ones.

use crate::contenders::{Check, Contender, GOALS, contenders};
use crate::plot::Dot;
use crate::prelude::*;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let scenes = contenders(results)?;
    let all: Vec<&Contender> = scenes.values().flatten().collect();
    if all.is_empty() {
        let text = "There is no price list: it takes errors against references from two seeds or more.";
        return Ok(vec![Block::notice(text)]);
    }
    let name = |contender: &Contender| {
        if scenes.len() > 1 { format!("{}: {}", contender.image.scene, contender.name) } else { contender.name.clone() }
    };
    let seconds = |contender: &Contender, goal: f64| Some(contender.renderer.price(goal)?.seconds);
    let dots = |contender: &Contender| {
        let dot = |goal: f64| {
            Some(Dot { hollow: is_beyond(contender, goal), ..Estimated::from(seconds(contender, goal)?).dot() })
        };
        GOALS.map(dot).to_vec()
    };
    let rows = all.iter().map(|contender| DotRow::new(name(contender), dots(contender))).collect();
    let title = Title::new("What each accuracy costs").with_result(result(&scenes));
    let plot = DotPlot::new(title, Axis::log("seconds of rendering"), rows);
    let mut plot = plot.grouped(GOALS.map(|goal| format!("RMSE {goal}")));
    plot.subtitle = results.workload();
    plot.caption = format!("Bars: 95 % interval of error and time together. {}", extrapolated(&all));
    let checks: Vec<(&Contender, Option<Check>)> =
        all.iter().map(|contender| (*contender, contender.check())).collect();
    let mut blocks = vec![Block::figure("price-list", plot)];
    blocks.extend(checked(&checks));

    let mut table = Block::table("price-list", "Price list, intervals of 95 %", checks)
        .column("renderer", |(contender, _)| name(contender))
        .number("variance of a sample", Significant(3), |(contender, _)| variance(contender))
        .estimated("s per sample and pixel", Significant(3), |(own, _)| Estimated::from(own.renderer.seconds_per_spp))
        .estimated("efficiency, 1 / (variance x s)", Significant(3), |(own, _)| {
            own.renderer.efficiency().map(Estimated::from)
        });
    table = table.number("least RMSE that was measured", Significant(3), |(contender, _)| least_error(contender));
    for goal in GOALS {
        let head = format!("seconds to an RMSE of {goal}");
        table = table.estimated(head, Significant(3), |(contender, _)| seconds(contender, goal).map(Estimated::from));
    }
    let table = table
        .number("predicted for spp", Decimals(0), |(_, found)| found.as_ref().map(|check| f64::from(check.spp)))
        .number("RMSE, measured / predicted", Decimals(3), |(_, found)| found.as_ref().map(|check| check.rmse))
        .number("seconds, measured / predicted", Decimals(3), |(_, found)| found.as_ref().map(|check| check.seconds));
    blocks.push(table.end());
    Ok(blocks)
}

/// The result in a line, in the scene with the most contenders: the lowest and the highest price of the error that most
/// of them reach.
fn result(scenes: &BTreeMap<String, Vec<Contender>>) -> Option<String> {
    let (scene, all) = scenes.iter().rev().max_by_key(|(_, contenders)| contenders.len())?;
    let priced = |goal: f64| -> Vec<(&str, Estimated)> {
        let reached = all.iter().filter(|contender| !is_beyond(contender, goal));
        let price = |own: &Contender| Some(Estimated::from(own.renderer.price(goal)?.seconds));
        reached.filter_map(|own| Some((own.name.as_str(), price(own)?))).collect()
    };
    let goals = GOALS.map(|goal| (goal, priced(goal)));
    let (goal, found) = goals.into_iter().max_by(|a, b| a.1.len().cmp(&b.1.len()).then(b.0.total_cmp(&a.0)))?;
    if found.len() < 2 {
        return None;
    }
    let of = if scenes.len() > 1 { format!(" on {scene}") } else { String::new() };
    Some(match titles::ends_apart(found) {
        Some([(cheap, least), (dear, most)]) => format!(
            "An RMSE of {goal}{of} costs {} s with {cheap}, {} s with {dear}",
            titles::told(least)?,
            titles::told(most)?
        ),
        None => format!("This machine cannot tell what reaches an RMSE of {goal}{of} first"),
    })
}

/// The RMSE at the largest number of samples.
fn least_error(contender: &Contender) -> Option<f64> {
    contender.points.last().map(|point| point.rmse)
}

/// Whether no measured point has so small an error.
fn is_beyond(contender: &Contender, goal: f64) -> bool {
    least_error(contender).is_some_and(|least| goal < least)
}

/// The number of prices beyond the measured samples, in words.
fn extrapolated(all: &[&Contender]) -> String {
    let prices = || all.iter().flat_map(|contender| GOALS.map(|goal| (contender, goal)));
    let beyond = prices().filter(|(contender, goal)| is_beyond(contender, *goal)).count();
    let count = prices().count();
    match beyond {
        0 => "Every price lies within the measured samples.".to_string(),
        _ => format!(
            "Hollow: extrapolated beyond the measured samples, {beyond} of {count} prices, those below the least measured RMSE (table)."
        ),
    }
}

fn variance(contender: &Contender) -> Option<f64> {
    let renderer = &contender.renderer;
    Some(renderer.efficiency()?.times(&renderer.seconds_per_spp)?.inverse()?.value)
}

/// A finding about the largest errors of the predictions.
fn checked(checks: &[(&Contender, Option<Check>)]) -> Option<Block> {
    let worst = |of: &dyn Fn(&Check) -> f64| {
        let off = checks.iter().filter_map(|(c, check)| Some((&c.name, 100.0 * (of(check.as_ref()?) - 1.0))));
        off.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    };
    let ((by_error, error), (by_time, time)) = (worst(&|check| check.rmse)?, worst(&|check| check.seconds)?);
    Some(Block::finding(format!(
        "Half of the seeds, up to a quarter of the samples, predict RMSE and seconds of the other half at the end of its curves. At worst the RMSE came out {error:+.1} % ({by_error}) and the \
         seconds {time:+.1} % ({by_time}) of what was predicted. Half of an error costs four times the seconds with independent samples."
    )))
}

#[cfg(test)]
mod tests {
    use crate::figures::blocks;
    use crate::measure::Record;
    use crate::tests::{results, row, svg};

    /// MSE = scale / n up to 16 samples: a scale of .02 ends at an RMSE of .035, which .1 and .05 lie above.
    #[test]
    fn extrapolated_prices_are_hollow() {
        let figure = |scale: f64| {
            let mut rows = Vec::new();
            for (seed, spp) in (1..=3_u32).flat_map(|seed| [1, 4, 16].map(|spp| (seed, spp))) {
                let factor = 1.0 + 0.01 * f64::from(seed);
                let (mse, makespan_s) = (scale * factor / f64::from(spp), Some(factor * f64::from(spp)));
                rows.push(Record { seed: seed.into(), spp, mse: Some(mse), makespan_s, ..row() });
            }
            svg(&blocks(&results(&["price-list"], "", rows).unwrap()).unwrap(), "price-list")
        };
        assert!(figure(0.02).contains("Hollow: extrapolated beyond the measured samples, 2 of 4 prices"));
        assert!(figure(0.001).contains("Every price lies within the measured samples"));
    }
}
