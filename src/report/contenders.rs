//! The ways to render a scene that an experiment compares, as prices see them: error curves over seeds, and seconds per sample.

use super::block::Block;
use super::results::{LEVEL, Results, Schedule};
use crate::analysis::Interval;
use crate::analysis::jackknife::{Curve, SeedCurves};
use crate::analysis::mean::geometric_interval;
use crate::analysis::mse::over_seeds;
use crate::analysis::price::{Law, Renderer};
use crate::experiment::{EXTERNAL, law_of};
use crate::measure::{Record, Warning};
use std::collections::{BTreeMap, BTreeSet};

/// An estimator with a sampler and a schedule, on a scene.
pub(super) struct Contender {
    /// What tells it from the others.
    pub(super) name: String,
    /// The scene.
    pub(super) scene: String,
    /// Its estimator.
    pub(super) estimator: String,
    /// Its kernel, in words.
    pub(super) kernel: String,
    /// Its workers.
    pub(super) threads: usize,
    /// When and how chance ends its paths.
    pub(super) roulette: String,
    /// Its points, by samples per pixel.
    pub(super) points: Vec<CostPoint>,
    /// What its prices are made from.
    pub(super) renderer: Renderer,
    /// Each seed's own curve and seconds per sample and pixel.
    seeds: Vec<(Curve, f64)>,
}

/// Error and time after so many samples.
pub(super) struct CostPoint {
    pub(super) spp: u32,
    /// Mean seconds over seeds.
    pub(super) seconds: f64,
    /// Root of the mean squared error.
    pub(super) rmse: f64,
    pub(super) interval: Option<Interval>,
    /// Standard deviation of the seeds' squared errors over their mean.
    pub(super) variation: Option<f64>,
}

/// What a part of the seeds and samples predicts for the rest.
pub(super) struct Check {
    /// Samples per pixel that were predicted for.
    pub(super) spp: u32,
    /// RMSE of the other seeds over the predicted one.
    pub(super) rmse: f64,
    /// Their seconds over the predicted ones.
    pub(super) seconds: f64,
}

impl Contender {
    fn of(name: String, records: &[&Record]) -> Option<Self> {
        let first = *records.first()?;
        let seeds = curves_of_seeds(records);
        let law = law_of(&first.sampler);
        let mut points = Vec::new();
        let mut by_spp: BTreeMap<u32, Vec<&Record>> = BTreeMap::new();
        for record in records {
            by_spp.entry(record.spp).or_default().push(record);
        }
        for (spp, rows) in by_spp {
            let mse: BTreeMap<u64, f64> = rows.iter().filter_map(|row| Some((row.seed, row.mse?))).collect();
            let mse: Vec<f64> = mse.into_values().collect();
            let times: Vec<f64> = rows.iter().filter_map(|row| row.makespan_s).collect();
            let error = over_seeds(&mse, LEVEL);
            points.push(CostPoint {
                spp,
                seconds: times.iter().sum::<f64>() / times.len() as f64,
                rmse: (mse.iter().sum::<f64>() / mse.len() as f64).sqrt(),
                interval: error.map(|error| error.rmse.interval),
                variation: error.map(|error| error.variation),
            });
        }
        let renderer = renderer(&seeds, law)?;
        Some(Self {
            name,
            scene: first.scene.clone(),
            estimator: first.estimator.clone(),
            kernel: first.kernel_name(),
            threads: first.threads,
            roulette: first.roulette.clone(),
            points,
            renderer,
            seeds,
        })
    }

    /// The first half of the seeds, up to a quarter of the samples, predicts the rest. `None` below six seeds or two points in that quarter.
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

/// (spp, squared error) of each seed, and its seconds for a sample in every pixel, from its longest render. An spp at which some seed's
/// squared error is not positive, or not there, is left out for all: leaving out that seed alone would bias the rest upwards.
fn curves_of_seeds(records: &[&Record]) -> Vec<(Curve, f64)> {
    let seeds: BTreeSet<u64> = records.iter().map(|record| record.seed).collect();
    let spps: BTreeSet<u32> = records.iter().map(|record| record.spp).collect();
    let at = |seed: u64, spp: u32| records.iter().find(|record| record.seed == seed && record.spp == spp);
    let mse = |seed: u64, spp: u32| at(seed, spp)?.mse.filter(|mse| *mse > 0.0);
    let whole: Vec<u32> =
        spps.iter().copied().filter(|&spp| seeds.iter().all(|&seed| mse(seed, spp).is_some())).collect();
    let of_seed = |&seed: &u64| {
        let curve: Curve = whole.iter().filter_map(|&spp| Some((f64::from(spp), mse(seed, spp)?))).collect();
        let longest = spps.iter().rev().find_map(|&spp| Some(at(seed, spp)?.makespan_s? / f64::from(spp)))?;
        Some((curve, longest))
    };
    seeds.iter().filter_map(of_seed).collect()
}

/// What is said of other programs that were not there.
pub(super) fn missing(results: &Results) -> Option<Block> {
    let names: BTreeSet<&str> = results
        .records
        .iter()
        .filter(|record| record.warnings.contains(&Warning::NoProgram.to_string()))
        .map(|record| record.estimator.as_str())
        .collect();
    let list: Vec<&str> = names.into_iter().collect();
    let text =
        format!("Left out, because the program is not there: {}. The definition says how it is made.", list.join(", "));
    (!list.is_empty()).then_some(Block::Finding(text))
}

/// The contenders of each scene, scenes by name and contenders in the order in which the estimators are listed. What cannot be priced, such as a single seed,
/// is left out.
pub(super) fn contenders(results: &Results) -> BTreeMap<String, Vec<Contender>> {
    const KERNEL: usize = 6;
    let parts: [fn(&Record) -> String; 7] = [
        |record| record.estimator.clone(),
        |record| record.sampler.clone(),
        |record| record.roulette.clone(),
        |record| record.max_depth.map_or_else(String::new, |depth| format!("depth {depth}")),
        |record| if record.biased && record.max_depth.is_none() { "biased".to_string() } else { String::new() },
        |record| Schedule::of(record).label(),
        Record::kernel_name,
    ];
    // Of another program there is nothing but its name.
    let is_own = |record: &Record| record.strategy != EXTERNAL;
    let rows = || results.records.iter().filter(|record| record.mse.is_some());
    let mut differs: Vec<bool> = parts
        .iter()
        .map(|part| rows().filter(|row| is_own(row)).map(part).collect::<BTreeSet<_>>().len() > 1)
        .collect();
    // A sampler that lanes have no code for makes kernels differ that nobody compares.
    let with_kernels: BTreeSet<_> =
        rows().map(|row| (&row.estimator, &row.sampler, row.kernel_name(), row.threads)).collect();
    let without: BTreeSet<_> = rows().map(|row| (&row.estimator, &row.sampler, row.threads)).collect();
    differs[KERNEL] &= with_kernels.len() > without.len();
    let name = |record: &Record| {
        let shown = parts
            .iter()
            .zip(&differs)
            .enumerate()
            .filter(|(index, (_, differs))| *index == 0 || (**differs && is_own(record)));
        let words: Vec<String> = shown.map(|(_, (part, _))| part(record)).filter(|word| !word.is_empty()).collect();
        words.join(" + ")
    };
    let order = results.definition.estimator_names();
    let place = |record: &Record| order.iter().position(|name| *name == record.estimator).unwrap_or(order.len());
    let mut groups: BTreeMap<(String, usize, String), Vec<&Record>> = BTreeMap::new();
    for record in rows() {
        groups.entry((record.scene.clone(), place(record), name(record))).or_default().push(record);
    }
    let mut scenes: BTreeMap<String, Vec<Contender>> = BTreeMap::new();
    for ((scene, _, name), records) in groups {
        scenes.entry(scene).or_default().extend(Contender::of(name, &records));
    }
    scenes.retain(|_, contenders| !contenders.is_empty());
    scenes
}
