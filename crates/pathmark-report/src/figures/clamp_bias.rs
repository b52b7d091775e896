//! The cost of clamping each subpixel before averaging: it loses light, but less with more samples.

use crate::analysis::mean::Moments;
use crate::prelude::*;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Options {
    /// The loss of another program: its name, and (spp, bias in per cent).
    prototype: Option<Prototype>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Prototype {
    name: String,
    bias: Vec<(u32, f64)>,
}

/// The loss at some number of samples, in per cent of the clamped limit.
struct Loss {
    spp: u32,
    seeds: usize,
    lost: Estimated,
    prototype: Option<f64>,
}

fn radiance(rows: &[&Row]) -> Option<f64> {
    Moments::of(&values(rows, |row| row.mean_radiance)).mean()
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Options { prototype } = options(&results.definition, "clamp-bias")?;
    let lit = results.rows().filter(|row| row.mean_radiance.is_some());
    // One scene in one size: other images have other light.
    let images = group(lit, |row| (&row.scene, &row.scene_hash, row.width, row.height));
    let own = images.into_values().rev().max_by_key(Vec::len).unwrap_or_default();
    let by_clamp = group(own, |row| (row.clamp.as_str(), row.spp));
    let of = |clamp: &'static str| by_clamp.iter().filter(move |((own, _), _)| *own == clamp);
    let plain: Vec<&Row> = of("").flat_map(|(_, rows)| rows).copied().collect();
    let last = of("subpixel").next_back().and_then(|((_, spp), rows)| Some((*spp, radiance(rows)?)));
    let (Some((largest, limit)), Some(truth)) = (last, radiance(&plain)) else {
        let text = "There is no bias to show: it takes rows with and without the clamp.";
        return Ok(vec![Block::notice(text)]);
    };
    let known = |spp: u32| prototype.as_ref()?.bias.iter().find(|(of, _)| *of == spp).map(|(_, bias)| *bias);
    let losses = of("subpixel").filter(|((_, spp), _)| *spp < largest).filter_map(|((_, spp), rows)| {
        let losses = values(rows, |row| Some(100.0 * (row.mean_radiance? / limit - 1.0)));
        Some(Loss { spp: *spp, seeds: losses.len(), lost: Estimated::mean(&losses)?, prototype: known(*spp) })
    });
    let losses: Vec<Loss> = losses.collect();
    let points = losses.iter().map(|loss| loss.lost.above(f64::from(loss.spp))).collect();
    let mut series = vec![Series::new("measured here", Look::nth(0), points)];
    series.extend(prototype.as_ref().map(|prototype| {
        let points = prototype.bias.iter().map(|&(spp, bias)| Point::new(f64::from(spp), bias)).collect();
        Series::new(&prototype.name, Look::nth(1), points).scattered()
    }));
    let first = losses.first().and_then(|loss| Some((loss.spp, loss.lost, loss.lost.interval?)));
    let result = first.filter(|(.., interval)| interval.high < 0.0).map(|(spp, lost, _)| {
        let darker = titles::percent(-lost.value / 100.0);
        format!("Clamped at {spp} samples per pixel, the image is {darker} darker than at {largest}")
    });
    let mut chart = LineChart::new(
        Title::new("Light lost by clamping each subpixel before averaging").with_result(result),
        Axis::log("samples per pixel").ticks_at(losses.iter().map(|loss| f64::from(loss.spp))),
        Axis::linear("mean radiance against the clamped limit, %").including([0.0]),
        series,
    );
    chart.dodge = 8.0;
    chart.subtitle = results.workload();
    let other = prototype.as_ref().map_or("", |_| {
        " Prototype: another program with the same estimator; the experiment's file gives its values, without intervals."
    });
    chart.caption = format!("Bars: 95 % interval over seeds. The limit is the clamped image at {largest} spp.{other}");
    let apart = losses.iter().filter_map(|loss| Some((loss.lost.value - loss.prototype?).abs())).reduce(f64::max);
    let beside = apart.map_or_else(String::new, |worst| {
        format!("; what was measured here is within {worst:.1} points of the prototype at every number of samples")
    });
    let finding = format!(
        "Clamped, the image converges to a mean radiance of {limit:.4} instead of {truth:.4}: {:.1} % of the light is above what a display shows and goes for good. On the way there the clamp takes \
         more, and how much depends on the samples{beside}. Images with different samples per pixel so \
         do not estimate the same picture, and errors against a clamped reference do not fall along a line.",
        100.0 * (1.0 - limit / truth)
    );
    let table = Block::table("clamp-bias", "Bias of the subpixel clamp", &losses)
        .column("spp", |loss| loss.spp.to_string())
        .column("seeds", |loss| loss.seeds.to_string())
        .estimated("bias against the clamped limit, %", Decimals(2), |loss| loss.lost)
        .number("prototype, %", Decimals(1), |loss| loss.prototype)
        .number("bias against the true light, %", Decimals(2), |loss| {
            100.0 * ((1.0 + loss.lost.value / 100.0) * limit / truth - 1.0)
        })
        .end();
    let mut blocks = vec![Block::figure("clamp-bias", chart), Block::finding(finding), table];
    blocks.extend(recursion(&by_clamp, truth));
    Ok(blocks)
}

/// A finding about the light that clamping at every recursion loses, by samples.
fn recursion(by_clamp: &BTreeMap<(&str, u32), Vec<&Row>>, truth: f64) -> Option<Block> {
    let own = by_clamp.iter().filter(|((clamp, _), _)| *clamp == "recursion");
    let losses: Vec<(u32, f64)> =
        own.filter_map(|((_, spp), rows)| Some((*spp, 100.0 * (1.0 - radiance(rows)? / truth)))).collect();
    let (first, last) = (losses.first()?, losses.last()?);
    Some(Block::finding(format!(
        "Clamped at every recursion, the image loses {:.1} % of the light at {} spp and {:.1} % at {}: every path is cut by itself, so no number of samples brings it back.",
        first.1, first.0, last.1, last.0
    )))
}
