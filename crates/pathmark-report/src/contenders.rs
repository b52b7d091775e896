//! Contenders: the ways to render a scene that an experiment compares by price. Each has error curves over seeds, and
//! seconds per sample.

use super::naming::{Part, needed};
use super::schedule::{crew, strategy};
use crate::analysis::jackknife::{Curve, SeedCurves, curves_of};
use crate::analysis::mean::geometric_interval;
use crate::analysis::mse::over_seeds;
use crate::analysis::price::{Law, Renderer};
use crate::error::InputError;
use crate::estimated::root_of_mean;
use crate::experiment::{EXTERNAL, law_of};
use crate::measure::{SETTINGS, Setting};
use crate::prelude::*;
use std::iter::once;

/// The RMSEs that figures price, in linear radiance.
pub(super) const GOALS: [f64; 4] = [0.1, 0.05, 0.02, 0.01];

/// An estimator with a sampler and a schedule, on a scene.
pub(super) struct Contender {
    /// Distinguishes it from the others.
    pub(super) name: String,
    /// The image that it renders, without samples and seed.
    pub(super) image: ImageKey,
    pub(super) schedule: ScheduleKey,
    pub(super) kernel: String,
    /// Its points, by samples per pixel.
    pub(super) points: Vec<CostPoint>,
    pub(super) renderer: Renderer,
    /// The error curve of each seed, and its seconds per sample in every pixel.
    seeds: Vec<(Curve, f64)>,
}

/// Error and time at some number of samples.
pub(super) struct CostPoint {
    pub(super) spp: u32,
    /// Mean seconds over seeds.
    pub(super) seconds: f64,
    /// Root of the mean squared error.
    pub(super) rmse: f64,
    pub(super) interval: Option<Interval>,
    /// Standard deviation of the seeds' squared errors, relative to their mean.
    pub(super) variation: Option<f64>,
}

/// Measured values beside those that a part of the seeds and samples predicts.
pub(super) struct Check {
    /// Samples per pixel of the prediction.
    pub(super) spp: u32,
    /// RMSE of the other seeds over the predicted RMSE.
    pub(super) rmse: f64,
    /// Their seconds over the predicted seconds.
    pub(super) seconds: f64,
}

impl Contender {
    fn of(name: String, rows: &[&Row]) -> Option<Self> {
        let first = *rows.first()?;
        let seeds = curves_of_seeds(rows);
        let renderer = renderer(&seeds, law_of(&first.sampler))?;
        let points = group(rows.iter().copied(), |row| row.spp).into_iter().map(|(spp, rows)| {
            let mse = one_per_seed(&rows, |row| row.mse);
            let times = values(rows, |row| row.rendering_s());
            let error = over_seeds(&mse, LEVEL);
            CostPoint {
                spp,
                seconds: times.iter().sum::<f64>() / times.len() as f64,
                rmse: root_of_mean(&mse),
                interval: error.map(|error| error.rmse.interval),
                variation: error.map(|error| error.variation),
            }
        });
        Some(Self {
            name,
            image: ImageKey { spp: 0, seed: 0, ..first.image.clone() },
            schedule: first.schedule.key.clone(),
            kernel: first.kernel_name(),
            points: points.collect(),
            renderer,
            seeds,
        })
    }

    /// The variance of a sample at the end of its curve.
    pub(super) fn variance(&self) -> Option<f64> {
        self.renderer.curves.whole().last().map(|(spp, mse)| spp * mse)
    }

    /// Predicts the other seeds from the first half of the seeds and up to a quarter of the samples. `None` below six
    /// seeds or two points in that quarter.
    pub(super) fn check(&self) -> Option<Check> {
        let half = self.seeds.len() / 2;
        let (pilot, paid) = self.seeds.split_at_checked(half).filter(|_| half >= 3)?;
        let (largest, _) = *paid.first()?.0.last()?;
        let part: Vec<(Curve, f64)> = pilot
            .iter()
            .map(|(curve, seconds)| {
                (curve.iter().copied().filter(|point| 4.0 * point.0 <= largest).collect(), *seconds)
            })
            .collect();
        let pilot = renderer(&part, self.renderer.law).filter(|_| part.iter().all(|(curve, _)| curve.len() > 1))?;
        let count = paid.len() as f64;
        let rmse = (paid.iter().filter_map(|(curve, _)| Some(curve.last()?.1)).sum::<f64>() / count).sqrt();
        let predicted = pilot.law.rmse(pilot.curves.whole(), largest)?;
        let seconds = paid.iter().map(|(_, seconds)| seconds).sum::<f64>() / count;
        Some(Check { spp: largest as u32, rmse: rmse / predicted, seconds: seconds / pilot.seconds_per_spp.value })
    }
}

fn renderer(seeds: &[(Curve, f64)], law: Law) -> Option<Renderer> {
    let (curves, seconds): (Vec<Curve>, Vec<f64>) = seeds.iter().cloned().unzip();
    Some(Renderer {
        curves: SeedCurves::of_errors(&curves)?,
        law,
        seconds_per_spp: geometric_interval(&seconds, LEVEL)?,
    })
}

/// The curve (spp, squared error) of each seed (see [`curves_of`]), and its seconds for a sample in every pixel, from its
/// longest render.
pub(super) fn curves_of_seeds(rows: &[&Row]) -> Vec<(Curve, f64)> {
    curves_by(rows, |row| row.mse)
}

/// The same for another squared error.
pub(super) fn curves_by(rows: &[&Row], error: fn(&Row) -> Option<f64>) -> Vec<(Curve, f64)> {
    let mut seeds: BTreeMap<u64, BTreeMap<u32, &Row>> = BTreeMap::new();
    for row in rows {
        seeds.entry(row.seed).or_default().entry(row.spp).or_insert(row);
    }
    let errors = group(rows.iter().copied(), |row| row.spp).into_iter().map(|(spp, rows)| (spp, by_seed(&rows, error)));
    let curves = curves_of(&seeds.keys().copied().collect(), errors.collect());
    let longest = |rows: &BTreeMap<u32, &Row>| {
        rows.iter().rev().find_map(|(spp, row)| Some(row.rendering_s()? / f64::from(*spp)))
    };
    curves.into_iter().filter_map(|(seed, curve)| Some((curve, longest(seeds.get(&seed)?)?))).collect()
}

pub(super) fn one_per_seed(rows: &[&Row], value: impl Fn(&Row) -> Option<f64>) -> Vec<f64> {
    by_seed(rows, value).into_values().collect()
}

/// The value of each seed. All schedules and repetitions of a seed render the same image, and images of other settings
/// may share its samples: only seeds are independent, and more values than seeds would make intervals falsely narrow.
/// The value of several images is their mean. An image that a seed lacks is left out for all seeds.
fn by_seed(rows: &[&Row], value: impl Fn(&Row) -> Option<f64>) -> BTreeMap<u64, f64> {
    let mut images: BTreeMap<ImageKey, BTreeMap<u64, f64>> = BTreeMap::new();
    for (row, value) in rows.iter().filter_map(|row| Some((row, value(row)?))) {
        let image = row.image.without_seed();
        images.entry(image).or_default().entry(row.seed).or_insert(value);
    }
    let seeds: BTreeSet<u64> = images.values().flat_map(BTreeMap::keys).copied().collect();
    images.retain(|_, values| values.len() == seeds.len());
    let mean = |seed| images.values().filter_map(|values| values.get(&seed)).sum::<f64>() / images.len() as f64;
    seeds.into_iter().filter(|_| !images.is_empty()).map(|seed| (seed, mean(seed))).collect()
}

/// The contenders of each scene: scenes by name, with the image size if there are several, because seconds of different
/// sizes are not compared; contenders in the order of the estimators in the definition. Leaves out contenders without a
/// price, such as those with a single seed.
pub(super) fn contenders(results: &Results) -> Result<BTreeMap<String, Vec<Contender>>> {
    let priced = results.rows().filter(|row| row.mse.is_some());
    let groups = group(priced, |row| {
        let (mut image, schedule, _) = row.key(|_, _| ());
        (image.spp, image.seed) = (0, 0);
        (image, schedule)
    });
    let groups: Vec<Vec<&Row>> = groups.into_values().collect();
    let names = names(&groups.iter().map(|rows| rows[0]).collect::<Vec<_>>());
    let order = results.definition.estimator_names();
    let place = |row: &Row| order.iter().position(|name| *name == row.estimator).unwrap_or(order.len());
    let size = |row: &Row| format!("{}x{}", row.width, row.height);
    let sizes = group(groups.iter().map(|rows| rows[0]), |row| &row.scene);
    let has_several: BTreeSet<&String> = sizes
        .into_iter()
        .filter(|(_, rows)| rows.iter().any(|row| size(row) != size(rows[0])))
        .map(|(scene, _)| scene)
        .collect();
    let mut named: BTreeMap<(String, usize, String), Vec<&Row>> = BTreeMap::new();
    for (rows, name) in groups.into_iter().zip(names) {
        let cell = &rows[0].cell;
        let own_size = if has_several.contains(&rows[0].scene) { size(rows[0]) } else { String::new() };
        let scene = joined([rows[0].scene.clone(), own_size]);
        if let Some(other) = named.insert((scene, place(rows[0]), name), rows) {
            let problem = format!("is not told from {} by any name that figures have", other[0].cell);
            return Err(InputError::new("cell", cell, problem).into());
        }
    }
    let mut scenes: BTreeMap<String, Vec<Contender>> = BTreeMap::new();
    for ((scene, _, name), rows) in named {
        scenes.entry(scene).or_default().extend(Contender::of(name, &rows));
    }
    scenes.retain(|_, contenders| !contenders.is_empty());
    Ok(scenes)
}

/// Names the contenders, each given by a row: the estimator, the properties that differ, and any others needed to
/// distinguish them.
fn names(rows: &[&Row]) -> Vec<String> {
    let main: [Part<Row>; 6] = [
        |row| row.estimator.clone(),
        |row| row.sampler.clone(),
        |row| row.roulette.clone(),
        |row| row.max_depth.map_or_else(String::new, |depth| format!("depth {depth}")),
        |row| if row.biased && row.max_depth.is_none() { "biased".to_string() } else { String::new() },
        |row| crew(strategy(row), row.threads),
    ];
    let label = |setting: &Setting, row: &Row| setting.label_of(&row.image, &row.schedule.key).unwrap_or_default();
    // Another program has only a name.
    let own: Vec<&Row> = rows.iter().copied().filter(|row| row.strategy != EXTERNAL).collect();
    let differs = |part: &Part<Row>| own.iter().map(|row| part(row)).collect::<BTreeSet<_>>().len() > 1;
    let mut parts: Vec<Part<Row>> = main[1..].iter().copied().filter(differs).collect();
    // A sampler without lane code makes kernels differ that nobody compares, so kernels are named only where needed.
    let who = |row: &Row| (row.estimator.clone(), row.sampler.clone(), row.threads);
    let kernel: Part<Row> = |row| row.kernel_name();
    parts.extend(needed(&own, who, [kernel], |part, row| part(row)));
    let told = |row: &Row| (row.scene.clone(), main[0](row), parts.iter().map(|part| part(row)).collect::<Vec<_>>());
    let more = needed(&own, told, SETTINGS.iter().filter(|setting| setting.is_label()), label);
    let name = |row: &Row| {
        let others = parts.iter().map(|part| part(row)).chain(more.iter().map(|setting| label(setting, row)));
        let words =
            once(main[0](row)).chain(others.filter(|_| row.strategy != EXTERNAL)).filter(|word| !word.is_empty());
        words.collect::<Vec<String>>().join(" + ")
    };
    rows.iter().map(|row| name(row)).collect()
}
