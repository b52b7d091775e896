//! Error by scene at the same samples per pixel. It tests report A's claim that scenes without reflections are more
//! accurate; a control exchanges the materials of one scene.

use crate::analysis::mean::geometric_interval;
use crate::analysis::rank::spearman;
use crate::prelude::*;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Options {
    /// The same box with three pairs of balls.
    control: Option<Control>,
}

/// Scenes that differ only in the balls of one box.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Control {
    /// With diffuse balls.
    diffuse: String,
    /// With a mirror and a glass ball.
    glass: String,
    /// With two mirror balls.
    mirrors: String,
}

/// Accuracy and cost of a scene.
struct Accuracy {
    /// The scene, or the properties in which the images differ.
    name: String,
    /// The image without its seed.
    image: ImageKey,
    /// Mean radiance over all pixels and channels, and all seeds.
    radiance: f64,
    /// Relative RMSE of each seed, without the scene.
    by_seed: Repeats,
    /// Root of the mean of their squares.
    error: Estimated,
    rays: f64,
    /// CPU seconds of a sample.
    sample_s: f64,
    pixels: f64,
}

impl Accuracy {
    /// CPU seconds until the image has an error of 1 % of the mean radiance; errors fall with the root of the samples.
    fn price_s(&self) -> f64 {
        let times = self.error.value / 0.01;
        let spp = f64::from(self.image.spp) * times * times;
        spp * self.pixels * self.sample_s
    }
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Options { control } = options(&results.definition, "scene-accuracy")?;
    let mut scenes = accuracies(results)?;
    if scenes.is_empty() {
        let text = "There is no accuracy by scene: it takes errors against references, and the kept images.";
        return Ok(vec![Block::notice(text)]);
    }
    scenes.sort_by(|a, b| a.error.value.total_cmp(&b.error.value));
    let correlation = correlation(&scenes, control.as_ref());
    let mut blocks = vec![Block::figure("scene-accuracy", chart(results, &scenes, correlation.as_ref()))];
    blocks.extend(correlation.as_ref().map(claim));
    blocks.extend(control.and_then(|control| controlled(&scenes, &control)));
    blocks.push(table(&scenes));
    Ok(blocks)
}

fn accuracies(results: &Results) -> Result<Vec<Accuracy>> {
    let radiances = results.kept_images(|row| row.mse.is_some())?.into_iter().map(|(row, image)| {
        let channels = image.pixels.iter().flatten().copied();
        (kind(row), channels.sum::<f64>() / (3 * image.pixels.len()) as f64)
    });
    let radiances = gathered(radiances);
    let of_scene = |(image, rows): (ImageKey, Vec<&Row>)| {
        let images = radiances.get(&image)?;
        let radiance = images.iter().sum::<f64>() / images.len() as f64;
        let first = *rows.first()?;
        let mse = |row: &Row| Some(row.mse? / (radiance * radiance));
        let squares = Repeats::of_images(rows.iter().copied(), ImageKey::forget_scene, mse).values();
        let error = Estimated { count: None, ..Estimated::rmse(&squares) };
        let series = results.series_name(first);
        let accuracy = Accuracy {
            name: if series.is_empty() { image.scene.clone() } else { series },
            radiance,
            by_seed: Repeats::of_images(rows.iter().copied(), ImageKey::forget_scene, |row| Some(mse(row)?.sqrt())),
            error,
            rays: typical(&rows, |row| Some(row.rays? as f64 / row.samples? as f64))?,
            sample_s: typical(&rows, |row| Some(row.cpu_s()? / row.samples? as f64))?,
            pixels: f64::from(first.width) * f64::from(first.height),
            image,
        };
        accuracy.error.value.is_finite().then_some(accuracy)
    };
    Ok(results.by(kind).into_iter().filter_map(of_scene).collect())
}

fn kind(row: &Row) -> ImageKey {
    row.image.without_seed()
}

/// The setting of an image apart from its scene and seed. Errors in different settings are not compared.
fn setting(scene: &Accuracy) -> ImageKey {
    let mut image = scene.image.clone();
    image.forget_scene();
    image
}

fn chart(results: &Results, scenes: &[Accuracy], correlation: Option<&Correlation>) -> LineChart {
    let point = |(index, scene): (usize, &Accuracy)| {
        Series::new(&scene.name, Look::nth(index), vec![scene.error.above(scene.rays)]).scattered()
    };
    let (x, y) = (Axis::log("rays per sample"), Axis::log("RMSE / mean radiance"));
    let series = scenes.iter().enumerate().map(point).collect();
    let result = correlation.map(|found| {
        let (words, rho) = (found.verdict(), found.rho);
        format!("Over {} scenes, {words} (rank correlation {rho:.2})", found.scenes)
    });
    let mut chart = LineChart::new(Title::new("Error and path length by scene").with_result(result), x, y, series);
    let samples = |row: &Row| format!("{}, {} samples per pixel, {}", results.size(), row.spp, row.estimator);
    chart.subtitle = results.first().map_or_else(String::new, samples);
    chart.caption = "Bars: 95 % interval over seeds.".to_string();
    chart
}

/// The rank correlation of rays per sample and relative error.
struct Correlation {
    scenes: usize,
    rho: f64,
    p: f64,
}

impl Correlation {
    fn verdict(&self) -> &'static str {
        match (self.p < 1.0 - LEVEL, self.rho > 0.0) {
            (true, true) => "longer paths and larger errors go together",
            (true, false) => "scenes with longer paths even have the smaller errors",
            (false, _) => "path length and error show no connection",
        }
    }
}

/// The rank correlation over different scenes. Leaves out the two variants of the control, which would count one scene
/// three times.
fn correlation(scenes: &[Accuracy], control: Option<&Control>) -> Option<Correlation> {
    let is_variant = |scene: &&Accuracy| {
        control.is_some_and(|control| [&control.diffuse, &control.mirrors].contains(&&scene.image.scene))
    };
    let others = gathered(scenes.iter().filter(|scene| !is_variant(scene)).map(|scene| (setting(scene), scene)));
    let others = others.into_values().rev().max_by_key(Vec::len)?;
    let pairs: Vec<(f64, f64)> = others.iter().map(|scene| (scene.rays, scene.error.value)).collect();
    let found = spearman(&pairs)?;
    Some(Correlation { scenes: others.len(), rho: found.rho, p: found.p })
}

fn claim(found: &Correlation) -> Block {
    Block::finding(format!(
        "Is a scene more accurate if its paths bounce less? Over {} different scenes the rank correlation of rays per sample and \
         relative error is {:.2} (p = {:.2}): {}.",
        found.scenes,
        found.rho,
        found.p,
        found.verdict(),
    ))
}

/// The ratio of the errors of two scenes, paired by seed: the mean of logarithms.
fn error_ratio(above: &Accuracy, below: &Accuracy) -> Option<Estimate> {
    geometric_interval(&above.by_seed.over(&below.by_seed).values(), LEVEL)
}

fn controlled(scenes: &[Accuracy], control: &Control) -> Option<Block> {
    let diffuse = scenes.iter().find(|scene| scene.image.scene == control.diffuse)?;
    let of = |name: &str| scenes.iter().find(|scene| scene.image.scene == name && setting(scene) == setting(diffuse));
    let (own, mirrors) = (of(&control.glass)?, of(&control.mirrors)?);
    let (glass, mirror) = (error_ratio(own, diffuse)?, error_ratio(mirrors, diffuse)?);
    let ratio = |found: &Estimate| {
        format!("{:.2} times ({:.2} to {:.2})", found.value, found.interval.low, found.interval.high)
    };
    let verdict = match (glass.interval.low > 1.0, mirror.interval.low > 1.0) {
        (true, true) => "Reflections cost accuracy in this box",
        (false, false) => "Beyond the noise, reflections cost this box no accuracy",
        (true, false) => "Glass costs this box accuracy; beyond the noise, mirrors do not",
        (false, true) => "Mirrors cost this box accuracy; beyond the noise, a mirror and a glass ball together do not",
    };
    let length = |scene: &Accuracy| format!("{:.2}", scene.rays);
    Some(Block::finding(format!(
        "The control changes the balls of one box and nothing else. With a mirror and a glass ball its relative error is {} that with diffuse balls, with two mirror balls {}; \
         rays per sample are {} with diffuse balls, {} and {}. {verdict}.",
        ratio(&glass),
        ratio(&mirror),
        length(diffuse),
        length(own),
        length(mirrors),
    )))
}

fn table(scenes: &[Accuracy]) -> Block {
    let variance = |scene: &Accuracy| f64::from(scene.image.spp) * scene.error.value * scene.error.value;
    Block::table("scene-accuracy-table", "Accuracy by scene, most accurate first", scenes)
        .column("scene", |scene| scene.name.clone())
        .number("mean radiance", Decimals(4), |scene| scene.radiance)
        .number("RMSE, linear", Decimals(4), |scene| scene.error.value * scene.radiance)
        .estimated("RMSE / mean radiance", Decimals(4), |scene| scene.error)
        .column("seeds", |scene| scene.by_seed.values().len().to_string())
        .number("rays per sample", Decimals(2), |scene| scene.rays)
        .number("ns per sample", Decimals(0), |scene| scene.sample_s * 1e9)
        .number("efficiency, 1 / (relative variance of a sample x µs)", Decimals(4), |scene| {
            1.0 / (variance(scene) * scene.sample_s * 1e6)
        })
        .number("processor seconds to 1 % error", Decimals(2), |scene| scene.price_s())
        .end()
}
