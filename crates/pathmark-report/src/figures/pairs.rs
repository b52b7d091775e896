//! Pairs of contenders: seconds to the same error, and error after the same seconds.

use crate::analysis::price::{equal_error, equal_time};
use crate::contenders::{Contender, contenders};
use crate::prelude::*;

/// Two contenders, and the error and time at which they are compared.
struct Pair<'a> {
    a: &'a Contender,
    b: &'a Contender,
    place: Place,
    time: Option<Estimate>,
    error: Option<Estimate>,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let scenes = contenders(results)?;
    let (mut pairs, mut blocks) = (Vec::new(), Vec::new());
    for (scene, contenders) in &scenes {
        let Some(place) = Place::of(contenders) else { continue };
        blocks.extend(finding(scene, contenders, &place).map(Block::finding));
        for (index, a) in contenders.iter().enumerate() {
            pairs.extend(contenders[index + 1..].iter().map(|b| Pair {
                a,
                b,
                place,
                time: equal_error(&a.renderer, &b.renderer, place.rmse),
                error: equal_time(&a.renderer, &b.renderer, place.seconds),
            }));
        }
    }
    if pairs.is_empty() {
        return Ok(Vec::new());
    }
    blocks.push(
        Block::table("pairs", "A against B: at equal error, and at equal time", pairs)
            .column("scene", |pair| pair.a.image.scene.clone())
            .column("A", |pair| pair.a.name.clone())
            .column("B", |pair| pair.b.name.clone())
            .number("at RMSE", Decimals(4), |pair| pair.place.rmse)
            .estimated("seconds of A / seconds of B", Decimals(3), |pair| pair.time.map(Estimated::from))
            .number("after seconds", Decimals(3), |pair| pair.place.seconds)
            .estimated("RMSE of A / RMSE of B", Decimals(3), |pair| pair.error.map(Estimated::from))
            .end(),
    );
    Ok(blocks)
}

/// The error and the time at which a scene's contenders are compared: the largest final error, and the shortest final
/// time.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub(super) rmse: f64,
    seconds: f64,
}

impl Place {
    fn of(contenders: &[Contender]) -> Option<Self> {
        let ends = || contenders.iter().filter_map(|contender| contender.points.last());
        let rmse = ends().map(|point| point.rmse).filter(|rmse| rmse.is_finite()).reduce(f64::max)?;
        Some(Self { rmse, seconds: ends().map(|point| point.seconds).reduce(f64::min)? })
    }
}

/// The contender other than the first that reaches the same error soonest, and the first one's seconds over its seconds.
pub(super) fn soonest(contenders: &[Contender]) -> Option<(Place, &Contender, Estimate)> {
    let place = Place::of(contenders)?;
    let (first, others) = contenders.split_first()?;
    let against = |other: &Contender| equal_error(&first.renderer, &other.renderer, place.rmse);
    let ratios = others.iter().filter_map(|other| Some((other, against(other)?)));
    let (best, ratio) = ratios.max_by(|a, b| a.1.value.total_cmp(&b.1.value))?;
    Some((place, best, ratio))
}

/// Compares the first contender, which is the yardstick, with the one that reaches the same error soonest.
fn finding(scene: &str, contenders: &[Contender], place: &Place) -> Option<String> {
    let first = contenders.first()?;
    let (_, best, ratio) = soonest(contenders)?;
    let less = first.variance()? / best.variance()?;
    let slower = best.renderer.seconds_per_spp.value / first.renderer.seconds_per_spp.value;
    Some(format!(
        "{scene}: to an RMSE of {:.4}, {} takes {:.2} times the seconds of {} ({:.2} to {:.2}). Its samples have {less:.2} times the squared error at the end of the curves, and {} takes {slower:.2} \
         times as long for one.",
        place.rmse, first.name, ratio.value, best.name, ratio.interval.low, ratio.interval.high, best.name,
    ))
}
