//! Cost and gain of an approximation: light lost, noise and doubtful pixels by the value of one axis, against rows in
//! which the axis has its usual value.

use crate::prelude::*;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Options {
    /// The axis that is varied: `epsilon`, `filter`, `clamp`, or `scene` for scenes that are variants of the usual one.
    axis: Option<Varied>,
    usual: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Varied {
    Epsilon,
    Filter,
    Clamp,
    Scene,
}

/// The value of an axis in an image.
type Value = fn(&ImageKey) -> &str;

impl Varied {
    /// Its name, its value in an image, and a function that clears it there.
    fn parts(self) -> (&'static str, Value, fn(&mut ImageKey)) {
        match self {
            Self::Epsilon => ("epsilon", |image| &image.epsilon, |image| image.epsilon.clear()),
            Self::Filter => ("filter", |image| &image.filter, |image| image.filter.clear()),
            Self::Clamp => ("clamp", |image| &image.clamp, |image| image.clamp.clear()),
            Self::Scene => {
                ("variant", |image| &image.scene, |image| (image.scene, image.scene_hash) = Default::default())
            }
        }
    }
}

/// Results for one value on one scene at one number of samples.
struct Cost {
    scene: String,
    value: String,
    spp: u32,
    /// Mean radiance over the usual value's, paired by seed.
    light: Estimated,
    rmse: Option<f64>,
    within: Option<f64>,
    black: Option<f64>,
    fireflies: Option<f64>,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Options { axis, usual } = options(&results.definition, "bias")?;
    let (name, of, forget) = axis.unwrap_or(Varied::Epsilon).parts();
    let usual = usual.unwrap_or_else(|| "none".to_string());
    let mut costs = costs(results, of, forget, &usual);
    if costs.is_empty() {
        let text = format!("There is nothing to compare: it takes rows with and without {name}.");
        return Ok(vec![Block::notice(text)]);
    }
    let values = in_order(costs.iter().map(|cost| cost.value.clone()), &usual);
    let place = |cost: &Cost| values.iter().position(|value| *value == cost.value);
    costs.sort_by(|a, b| (&a.scene, place(a), a.spp).cmp(&(&b.scene, place(b), b.spp)));
    // The most samples show the bias with the least noise. The usual value does not count: it may have more samples.
    let mut most: BTreeMap<&str, u32> = BTreeMap::new();
    for cost in costs.iter().filter(|cost| cost.value != usual) {
        let spp = most.entry(&cost.scene).or_default();
        *spp = cost.spp.max(*spp);
    }
    let scenes: BTreeSet<&str> = costs.iter().map(|cost| cost.scene.as_str()).collect();
    let row = |value: &String| {
        let dot = |scene: &&str| {
            let is_shown =
                |cost: &&Cost| cost.value == *value && cost.scene == *scene && Some(&cost.spp) == most.get(scene);
            let own = costs.iter().find(is_shown)?;
            Some(own.light.times(100.0).dot())
        };
        DotRow::new(value, scenes.iter().map(dot).collect())
    };
    let mut plot = DotPlot::new(
        format!("Light by {name}"),
        Axis::linear(format!("mean radiance against {usual}, %")).including([100.0]),
        values.iter().map(row).collect(),
    )
    .grouped(scenes.iter().copied());
    plot.subtitle = results.workload();
    plot.caption =
        "Bars: 95 % interval over seeds, of ratios within a seed. Each scene at the most samples that were compared."
            .to_string();
    plot.guides = vec![(100.0, usual.clone())];
    let is_shown = |cost: &&Cost| cost.value != usual && Some(&cost.spp) == most.get(cost.scene.as_str());
    let worst = costs.iter().filter(is_shown).max_by(|a, b| {
        let off = |cost: &Cost| (cost.light.value - 1.0).abs();
        off(a).total_cmp(&off(b))
    });
    let finding = worst.map(|cost| {
        Block::finding(format!(
            "At {} samples per pixel the light changes most with {name} {} on {}: to {:.2} % of what it is with {usual}{}.",
            cost.spp,
            cost.value,
            cost.scene,
            100.0 * cost.light.value,
            cost.light.bar().map_or_else(String::new, |(low, high)| format!(
                " (95 % {:.2} to {:.2})",
                100.0 * low,
                100.0 * high
            )),
        ))
    });
    let percent = |share: Option<f64>| share.map(|share| 100.0 * share);
    let table = Block::table("bias", format!("Light, noise and doubtful pixels by {name}"), &costs)
        .column("scene", |cost| cost.scene.clone())
        .column(name, |cost| cost.value.clone())
        .column("spp", |cost| cost.spp.to_string())
        .estimated("light, %", Decimals(3), |cost| cost.light.times(100.0))
        .number("RMSE", Decimals(5), |cost| cost.rmse)
        .number("pixels within 0.05 of the display, %", Decimals(2), |cost| percent(cost.within))
        .number("black pixels, %", Decimals(3), |cost| percent(cost.black))
        .number("fireflies in a million pixels", Decimals(0), |cost| cost.fireflies.map(|share| 1e6 * share))
        .end();
    Ok([Block::figure("bias", plot)].into_iter().chain(finding).chain([table]).collect())
}

/// The values in order: the usual one, then by their numbers; a value without a number counts as 0.
fn in_order(values: impl Iterator<Item = String>, usual: &str) -> Vec<String> {
    let mut values: Vec<String> = values.collect::<BTreeSet<_>>().into_iter().collect();
    let number = |value: &str| value.rsplit(':').next().and_then(|number| number.parse().ok()).unwrap_or(0.0_f64);
    values.sort_by(|a, b| {
        let is_usual = |value: &str| value == usual;
        is_usual(b).cmp(&is_usual(a)).then(number(a).total_cmp(&number(b)))
    });
    values
}

fn costs(results: &Results, of: Value, forget: fn(&mut ImageKey), usual: &str) -> Vec<Cost> {
    // Images are compared whatever the kernel: an approximation may exist for one kernel only, and kernels give the
    // same image.
    let is_plain = |row: &&Row| of(&row.image).is_empty() || of(&row.image) == usual;
    let plain = results.rows().filter(is_plain);
    let plain = Repeats::of_images(plain, forget, |row| row.mean_radiance);
    // Variants of a scene stand beside each other under one name.
    let scene_of = |image: &ImageKey| {
        let mut image = image.clone();
        forget(&mut image);
        if image.scene.is_empty() { usual.to_string() } else { image.scene }
    };
    let cells = results.by(|row| (scene_of(&row.image), of(&row.image), row.spp));
    let cost = |((scene, value, spp), rows): ((String, &str, u32), Vec<&Row>)| {
        let rows = rows.into_iter().map(|row| (&row.image, row)).collect::<BTreeMap<_, _>>().into_values();
        let rows: Vec<&Row> = rows.collect();
        let light = Repeats::of_images(rows.iter().copied(), forget, |row| row.mean_radiance).over(&plain);
        let mean = |value: fn(&Row) -> Option<f64>| {
            let all = values(&rows, value);
            (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
        };
        Some(Cost {
            scene,
            value: if value.is_empty() { usual.to_string() } else { value.to_string() },
            spp,
            light: Estimated::mean(&light.values())?,
            rmse: mean(|row| row.rmse),
            within: mean(|row| row.within_tolerance),
            black: mean(|row| Some(row.black_pixels? as f64 / pixels(row))),
            fireflies: mean(|row| Some(row.fireflies? as f64 / pixels(row))),
        })
    };
    cells.into_iter().filter_map(cost).collect()
}

fn pixels(row: &Row) -> f64 {
    f64::from(row.width) * f64::from(row.height)
}
