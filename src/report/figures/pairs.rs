//! Every two ways to render a scene against each other: seconds to the same error, error after the same seconds.

use crate::analysis::Estimate;
use crate::analysis::versus::{equal_error, equal_time};
use crate::error::Result;
use crate::report::block::{Block, Table};
use crate::report::contenders::{Contender, contenders};
use crate::report::results::Results;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let scenes = contenders(results);
    let (mut rows, mut findings) = (Vec::new(), Vec::new());
    for (scene, contenders) in &scenes {
        let Some(place) = Place::of(contenders) else { continue };
        findings.extend(finding(scene, contenders, &place));
        for (index, a) in contenders.iter().enumerate() {
            for b in &contenders[index + 1..] {
                rows.push(row(scene, a, b, &place));
            }
        }
    }
    if rows.is_empty() {
        return Ok(Vec::new());
    }
    let columns = [
        "scene",
        "A",
        "B",
        "at RMSE",
        "seconds of A / seconds of B",
        "95 % interval",
        "after seconds",
        "RMSE of A / RMSE of B",
        "95 % interval",
    ];
    let title = "A against B: at equal error, and at equal time".to_string();
    let table = Table { title, columns: columns.map(String::from).to_vec(), rows };
    let mut blocks: Vec<Block> = findings.into_iter().map(Block::Finding).collect();
    blocks.push(Block::Table { stem: "pairs", table });
    Ok(blocks)
}

/// Where a scene's contenders are compared: the error that the least accurate one ends with, and the time at which the quickest one ends.
struct Place {
    rmse: f64,
    seconds: f64,
}

impl Place {
    fn of(contenders: &[Contender]) -> Option<Self> {
        let ends = || contenders.iter().filter_map(|contender| contender.points.last());
        let rmse = ends().map(|point| point.rmse).filter(|rmse| rmse.is_finite()).reduce(f64::max)?;
        Some(Self { rmse, seconds: ends().map(|point| point.seconds).reduce(f64::min)? })
    }
}

fn row(scene: &str, a: &Contender, b: &Contender, place: &Place) -> Vec<String> {
    let text = |estimate: Option<Estimate>| match estimate {
        Some(e) => [format!("{:.3}", e.value), format!("{:.3} to {:.3}", e.interval.low, e.interval.high)],
        None => ["-".to_string(), "-".to_string()],
    };
    let [time, time_interval] = text(equal_error(&a.renderer, &b.renderer, place.rmse));
    let [error, error_interval] = text(equal_time(&a.renderer, &b.renderer, place.seconds));
    vec![
        scene.to_string(),
        a.name.clone(),
        b.name.clone(),
        format!("{:.4}", place.rmse),
        time,
        time_interval,
        format!("{:.3}", place.seconds),
        error,
        error_interval,
    ]
}

/// The first contender, which is the yardstick, against the one that reaches the same error soonest.
fn finding(scene: &str, contenders: &[Contender], place: &Place) -> Option<String> {
    let (first, others) = contenders.split_first()?;
    let against = |other: &Contender| equal_error(&first.renderer, &other.renderer, place.rmse);
    let ratios = others.iter().filter_map(|other| Some((other, against(other)?)));
    let (best, ratio) = ratios.max_by(|a, b| a.1.value.total_cmp(&b.1.value))?;
    let variance = |contender: &Contender| {
        let &(spp, mse) = contender.renderer.curves.whole().last()?;
        Some(mse * spp)
    };
    let less = variance(first)? / variance(best)?;
    let slower = best.renderer.seconds_per_spp.value / first.renderer.seconds_per_spp.value;
    Some(format!(
        "{scene}: to an RMSE of {:.4}, {} takes {:.2} times the seconds of {} ({:.2} to {:.2}). Its samples have {less:.2} times the squared error at the end of the curves, and {} takes {slower:.2} \
         times as long for one.",
        place.rmse, first.name, ratio.value, best.name, ratio.interval.low, ratio.interval.high, best.name,
    ))
}
