//! Gains and costs of single precision: time, error, light and failures, beside double precision.

use super::prelude::*;
use crate::analysis::mean::t_interval;

const DOUBLE: &str = "f64";
const SINGLE: &str = "f32";

/// The light of each image, by seed and precision.
type Light<'a> = BTreeMap<(u64, &'a str), f64>;

/// A scene with an estimator in both precisions.
struct Pair<'a> {
    name: String,
    double: Vec<&'a Row>,
    single: Vec<&'a Row>,
    time: Estimate,
    /// The light of single precision over that of double, less 1.
    light: Option<Estimate>,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let mut light: BTreeMap<(&str, &str), Light<'_>> = BTreeMap::new();
    for (row, image) in results.kept_images(|row| row.kernel_fallback.is_empty())? {
        let seeds = light.entry((&row.scene, &row.estimator)).or_default();
        seeds.insert((row.seed, &row.precision), image.mean().iter().sum());
    }
    let rows = results.by(|row| (row.scene.as_str(), row.estimator.as_str(), row.precision.as_str()));
    let mut pairs = Vec::new();
    for ((scene, estimator), light) in &light {
        let of = |precision| rows.get(&(*scene, *estimator, precision)).cloned().unwrap_or_default();
        let (double, single) = (of(DOUBLE), of(SINGLE));
        let key = |row: &Row| {
            row.key(|image, schedule| {
                image.precision.clear();
                schedule.forget_kernel();
            })
        };
        let Some(time) = time_ratio(double.iter().copied(), single.iter().copied(), key, results.stopping())? else {
            continue;
        };
        let name = format!("{scene}: {estimator}");
        pairs.push(Pair { name, double, single, time, light: lighter(light) });
    }
    if pairs.is_empty() {
        return Ok(vec![Block::notice("Nothing was rendered in both precisions.")]);
    }
    let dots = pairs
        .iter()
        .filter_map(|pair| Some(PlotRow::new(&pair.name, vec![Some(Told::from(pair.light?).times(1e4).dot())])));
    let axis =
        Axis::linear("light of single precision over that of double, less 1, in ten-thousandths").including([0.0]);
    let mut plot = DotPlot::new("Is single precision darker or lighter?", axis, dots.collect());
    plot.guides = vec![(0.0, "as light".to_string())];
    plot.subtitle = results.machine_line();
    plot.caption =
        "Mean over seeds, both precisions with the same random numbers to fewer digits. Bars: 95 %.".to_string();
    let rmse = |rows: &[&Row]| {
        let mse = values(rows.iter().copied(), |row| row.mse);
        (mse.iter().sum::<f64>() / mse.len() as f64).sqrt()
    };
    let sum = |rows: &[&Row], count: fn(&Row) -> Option<u64>| {
        rows.iter().filter_map(|row| count(row)).sum::<u64>().to_string()
    };
    let table = Block::table("precision", "Single precision beside double", &pairs)
        .column("scene and estimator", |pair| pair.name.clone())
        .told("seconds of double / seconds of single", Decimals(2), |pair| Told::from(pair.time))
        .number("RMSE, double", Decimals(4), |pair| rmse(&pair.double))
        .number("RMSE, single", Decimals(4), |pair| rmse(&pair.single))
        .told("light of single / light of double - 1", Significant(2), |pair| pair.light.map(Told::from))
        .column("rays that met nothing, double", |pair| sum(&pair.double, |row| row.escaped))
        .column("rays that met nothing, single", |pair| sum(&pair.single, |row| row.escaped))
        .column("invalid samples, double", |pair| sum(&pair.double, |row| row.invalid_samples))
        .column("invalid samples, single", |pair| sum(&pair.single, |row| row.invalid_samples))
        .end();
    Ok(vec![Block::figure("precision", plot), table])
}

/// The mean over seeds of the light of single precision over that of double, less 1.
fn lighter(light: &Light<'_>) -> Option<Estimate> {
    let single = light.iter().filter(|((_, precision), _)| *precision == SINGLE);
    let ratios = single.filter_map(|((seed, _), single)| Some(single / light.get(&(*seed, DOUBLE))? - 1.0));
    t_interval(&ratios.collect::<Vec<f64>>(), LEVEL)
}
