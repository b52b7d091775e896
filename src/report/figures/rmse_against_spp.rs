//! Error against samples per pixel on two logarithmic axes. Independent samples fall along a line of slope -1/2.

use crate::analysis::jackknife::SeedCurves;
use crate::analysis::mse::over_seeds;
use crate::analysis::slope::power_law;
use crate::error::Result;
use crate::measure::Record;
use crate::plot::style::Look;
use crate::plot::{Axis, Curve, LineChart, Overlay, Point, Series};
use crate::report::block::{Block, Table};
use crate::report::results::{LEVEL, Results};
use std::collections::{BTreeMap, BTreeSet};

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let mut series = Vec::new();
    let mut overlays = Vec::new();
    let mut findings = Vec::new();
    let mut rows = Vec::new();
    let mut first_point = None;
    for (index, (name, records)) in results.by(|record| image_name(results, record)).into_iter().enumerate() {
        let mut points = Vec::new();
        for (spp, at_spp) in by_spp(&records) {
            let mse: Vec<f64> = one_per_seed(&at_spp, |record| record.mse).into_values().collect();
            let display: Vec<f64> = one_per_seed(&at_spp, |record| record.mse_display).into_values().collect();
            let error = over_seeds(&mse, LEVEL);
            let (value, shown) = (root_of_mean(&mse), root_of_mean(&display));
            let interval = error.map(|error| (error.rmse.interval.low, error.rmse.interval.high));
            if mse.is_empty() {
                continue;
            }
            points.push(Point::new(f64::from(spp), value).with_y(interval));
            rows.push(vec![
                name.clone(),
                spp.to_string(),
                mse.len().to_string(),
                format!("{value:.5}"),
                interval.map_or_else(|| "none".to_string(), |(low, high)| format!("{low:.5} to {high:.5}")),
                format!("{shown:.5}"),
            ]);
        }
        first_point = first_point.or_else(|| points.first().map(|point| (point.x, point.y)));
        if let Some(fit) =
            SeedCurves::of_errors(&curves_of_seeds(&records)).and_then(|curves| power_law(&curves, LEVEL))
        {
            let (slope, interval) = (fit.exponent.value, fit.exponent.interval);
            overlays.push(Overlay::fit(
                format!("fit: slope {slope:.3}\n95 % {:.3} to {:.3}", interval.low, interval.high),
                Curve::Power { scale: libm::exp(fit.log_scale), exponent: slope },
                index,
            ));
            let verdict = if interval.contains(-0.5) { "contains" } else { "does not contain" };
            findings.push(Block::Finding(format!(
                "{name}: RMSE falls as spp to the power {slope:.3}; the 95 % interval over {} seeds, {:.3} to {:.3}, {verdict} -1/2. \
                 Halving the error so takes {:.2} times the samples ({:.2} to {:.2}).",
                fit.seeds,
                interval.low,
                interval.high,
                libm::pow(0.5, 1.0 / slope),
                libm::pow(0.5, 1.0 / interval.low),
                libm::pow(0.5, 1.0 / interval.high),
            )));
            if fit.lacks_fit() {
                findings.push(Block::Finding(format!(
                    "{name}: the points do not lie on a line (the exponent changes along it by more than its interval), so no one exponent describes them."
                )));
            }
        }
        series.push(Series::new(name, Look::nth(index), points).scattered());
    }
    if let Some(curve) = first_point.and_then(|point| Curve::power_through(point, -0.5)) {
        overlays.insert(0, Overlay::guide("slope -1/2", curve));
    }
    let ticks: Vec<f64> = results.by(|record| record.spp).into_keys().map(f64::from).collect();
    let mut chart = LineChart::new(
        "Error against samples per pixel",
        Axis::log("samples per pixel").ticks_at(ticks),
        Axis::log("RMSE, linear radiance"),
        series,
    );
    chart.subtitle = results.workload();
    chart.caption =
        "Bars: 95 % interval over seeds. Squared errors are free of the references' noise (cross form).".to_string();
    chart.overlays = overlays;
    chart.dodge = 6.0;
    let table = Table {
        title: "Error by samples per pixel".to_string(),
        columns: ["image", "spp", "seeds", "RMSE, linear", "95 % interval", "RMSE, display"].map(String::from).to_vec(),
        rows,
    };
    let mut blocks = vec![Block::Figure { stem: "rmse-against-spp", figure: Box::new(chart) }];
    blocks.extend(findings);
    blocks.push(Block::Table { stem: "rmse-by-spp", table });
    Ok(blocks)
}

fn by_spp<'a>(records: &[&'a Record]) -> BTreeMap<u32, Vec<&'a Record>> {
    let mut groups: BTreeMap<u32, Vec<&Record>> = BTreeMap::new();
    for &record in records {
        groups.entry(record.spp).or_default().push(record);
    }
    groups
}

/// A value a seed: every schedule and repetition of a seed has the same image, so counting them again would narrow the interval falsely.
fn one_per_seed(records: &[&Record], value: impl Fn(&Record) -> Option<f64>) -> BTreeMap<u64, f64> {
    records.iter().filter_map(|record| Some((record.seed, value(record)?))).collect()
}

/// The mean first and the root last, as the cross form asks; NaN, which charts leave out, if the mean is below zero.
fn root_of_mean(mse: &[f64]) -> f64 {
    (mse.iter().sum::<f64>() / mse.len() as f64).sqrt()
}

/// (spp, squared error) of each seed. An spp at which some seed's squared error is not positive, or not there, is left out for all: leaving out
/// that seed alone would bias the rest upwards.
pub(super) fn curves_of_seeds(records: &[&Record]) -> Vec<Vec<(f64, f64)>> {
    let seeds: BTreeSet<u64> = records.iter().map(|record| record.seed).collect();
    let mut curves: BTreeMap<u64, Vec<(f64, f64)>> = BTreeMap::new();
    for (spp, at_spp) in by_spp(records) {
        let mse = one_per_seed(&at_spp, |record| record.mse);
        if mse.len() == seeds.len() && mse.values().all(|mse| *mse > 0.0) {
            for (seed, mse) in mse {
                curves.entry(seed).or_default().push((f64::from(spp), mse));
            }
        }
    }
    curves.into_values().collect()
}

/// The estimator, and whatever else differs among the images.
fn image_name(results: &Results, record: &Record) -> String {
    let series = results.series_name(record);
    if series.is_empty() { record.estimator.clone() } else { series }
}
