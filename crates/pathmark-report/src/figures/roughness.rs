//! Report B's microfacet material: directions sampled by the cosine, as in the report, or by the visible facets, at equal
//! samples.
//!
//! Scenes whose names differ only in their ending are the same image, with directions sampled in another way.

use crate::plot::number::short;
use crate::prelude::*;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct Options {
    /// The ending of the names of scenes whose directions follow the facets.
    by_facets: Option<String>,
}

/// A scene sampled both ways, and the ratios of cosine over facets.
struct Pair<'a> {
    scene: &'a str,
    cosine: &'a [&'a Row],
    facets: &'a [&'a Row],
    variance: Option<Estimated>,
    time: Option<Estimated>,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let by_facets =
        options::<Options>(&results.definition, "roughness")?.by_facets.unwrap_or_else(|| "-vndf".to_string());
    let rows = results.by(|row| row.scene.as_str());
    let base = |scene: &'_ str| scene.strip_suffix(by_facets.as_str()).unwrap_or(scene).len();
    let scenes: BTreeSet<(usize, &str)> = rows.keys().map(|scene| (base(scene), &scene[..base(scene)])).collect();
    let facets: BTreeMap<&str, &Vec<&Row>> =
        rows.iter().filter_map(|(scene, rows)| Some((scene.strip_suffix(by_facets.as_str())?, rows))).collect();
    let mut pairs = Vec::new();
    for (_, scene) in &scenes {
        let cosine = rows.get(scene).map_or(&[][..], Vec::as_slice);
        let facets = facets.get(scene).map_or(&[][..], |rows| rows.as_slice());
        let ratio = |value: &dyn Fn(&Row) -> Option<f64>| {
            let any_scene: Forget = |image, schedule| {
                image.scene.clear();
                image.scene_hash.clear();
                schedule.effects.clear();
            };
            let found = ratios(cosine.iter().copied(), facets.iter().copied(), any_scene, value);
            found.map(|found| found.median(results.stopping()))
        };
        let (variance, time) = (ratio(&variance)?, ratio(&|row| row.makespan_s)?);
        pairs.push(Pair { scene, cosine, facets, variance, time });
    }
    let mut blocks: Vec<Block> = sheet(results, &pairs)?.into_iter().collect();
    let compared: Vec<(&str, Estimated, Estimated)> =
        pairs.iter().filter_map(|pair| Some((pair.scene, pair.variance?, pair.time?))).collect();
    if !compared.is_empty() {
        blocks.push(Block::figure("roughness", plot(results, &compared)));
        blocks.extend(compared.iter().map(finding));
    }
    blocks.push(table(&pairs));
    Ok(blocks)
}

/// The squared error, which is the variance: on the pixels of the object, if the experiment names one, because the rest of
/// the image pulls every ratio towards 1. The cross form against two references removes their noise.
fn variance(row: &Row) -> Option<f64> {
    row.object_mse.or(row.mse).filter(|mse| *mse > 0.0)
}

fn plot(results: &Results, compared: &[(&str, Estimated, Estimated)]) -> DotPlot {
    let rows = compared
        .iter()
        .map(|(scene, variance, time)| DotRow::new(*scene, vec![Some(variance.dot()), Some(time.dot())]));
    let axis = Axis::log("by cosine / by facets, at equal samples").including([0.9, 1.1]);
    let errors = compared.iter().filter_map(|(scene, variance, _)| Some((*scene, Ratio::of(*variance)?)));
    let result = titles::largest_above_1(errors).map_or_else(
        || "The facets leave no smaller error than the cosine beyond the noise".to_string(),
        |(scene, ratio)| {
            format!("On {scene} the cosine leaves {} times the squared error of the facets", short(ratio.value, 3))
        },
    );
    let title = Title::new("What directions by the cosine cost").with_result(Some(result));
    let plot = DotPlot::new(title, axis, rows.collect());
    let of =
        results.definition.object().map_or_else(|| "image".to_string(), |object| format!("pixels of the {object}"));
    let mut plot = plot.grouped([format!("squared error, {of}"), "time".to_string()]);
    plot.guides = vec![(1.0, "the same".to_string())];
    plot.subtitle = results.run.machine.line();
    let bars = bars(compared.iter().flat_map(|(_, variance, time)| [*variance, *time]));
    plot.caption = format!("Ratios of runs with the same seed; above 1, the facets are better. {bars}");
    plot
}

fn finding((scene, variance, time): &(&str, Estimated, Estimated)) -> Block {
    let words = |interval: Option<Interval>| interval.map_or("no interval".to_string(), |i| with_level(&i, 2));
    let verdict = match variance.interval {
        Some(interval) if interval.low > 1.0 => "the facets are the better guide",
        Some(interval) if interval.high < 1.0 => "the cosine is the better guide",
        _ => "these runs do not tell the two apart",
    };
    Block::finding(format!(
        "{scene}: at equal samples directions by the cosine leave {:.2} times the squared error, {}, in {:.2} times the time, {}: {verdict}.",
        variance.value,
        words(variance.interval),
        time.value,
        words(time.interval),
    ))
}

fn table(pairs: &[Pair<'_>]) -> Block {
    let ways = pairs.iter().flat_map(|pair| {
        // A mirror reflects into one direction, however it is sampled.
        let cosine = if pair.facets.is_empty() { "the mirror's" } else { "cosine" };
        [(pair.scene, cosine, pair.cosine), (pair.scene, "facets", pair.facets)]
    });
    let lines = ways.filter_map(|(scene, directions, rows)| {
        let time = typical(rows, |row| Some(row.makespan_s? / row.samples? as f64 * 1e9))?;
        Some((scene, directions, rows.len(), typical(rows, variance), time))
    });
    // Monte Carlo efficiency: 1/(variance x time), with the time of a sample in microseconds.
    let efficiency = |variance: Option<f64>, time: f64| variance.map(|variance| 1.0 / (variance * time * 1e-3));
    Block::table("roughness-table", "Roughness: medians over seeds, errors of the compared pixels", lines)
        .column("scene", |(scene, ..)| (*scene).to_string())
        .column("directions", |(_, directions, ..)| (*directions).to_string())
        .column("runs", |(_, _, runs, ..)| runs.to_string())
        .number("RMSE, linear", Decimals(4), |(.., variance, _)| variance.map(f64::sqrt))
        .number("ns a sample", Decimals(0), |(.., time)| *time)
        .number("1 / (variance x us a sample)", Decimals(3), |(.., variance, time)| efficiency(*variance, *time))
        .end()
}

/// A sheet of the references, which show the material; the renders have too few samples for that.
fn sheet(results: &Results, pairs: &[Pair<'_>]) -> Result<Option<Block>> {
    let mut cells = Vec::new();
    for pair in pairs {
        let Some(image) = results.reference_image(Some(pair.scene))? else { return Ok(None) };
        cells.push(Some(Cell::of(&image, vec![pair.scene.to_string(), "reference".to_string()])?));
    }
    let title = "The material by roughness".to_string();
    let sheet = ContactSheet {
        title,
        subtitle: results.run.machine.line(),
        rows: vec![cells],
        bars: Vec::new(),
        comparison: Comparison::Wipe,
    };
    Block::sheet("roughness-images", &sheet).map(Some)
}
