//! Gains and costs of single precision: time, error, light and failures, beside double precision.

use super::kernels::any_kernel;
use crate::analysis::mean::t_interval;
use crate::estimated::root_of_mean;
use crate::plot::number::short;
use crate::prelude::*;

const DOUBLE: &str = "f64";
const SINGLE: &str = "f32";

/// A scene with an estimator in both precisions.
struct Pair<'a> {
    name: String,
    double: Vec<&'a Row>,
    single: Vec<&'a Row>,
    time: Ratio,
    /// The mean over seeds of the light of single precision over that of double, less 1.
    light: Option<Estimate>,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let kept = results.kept_images(|row| row.kernel_fallback.is_empty())?.into_iter();
    let light: BTreeMap<&ImageKey, f64> = kept.map(|(row, image)| (&row.image, image.mean().iter().sum())).collect();
    let kinds: BTreeSet<(&str, &str)> =
        light.keys().map(|image| (image.scene.as_str(), image.estimator.as_str())).collect();
    let rows = results.by(|row| (row.scene.as_str(), row.estimator.as_str(), row.precision.as_str()));
    let mut pairs = Vec::new();
    for (scene, estimator) in kinds {
        let of = |precision| rows.get(&(scene, estimator, precision)).cloned().unwrap_or_default();
        let (double, single) = (of(DOUBLE), of(SINGLE));
        let rows = [&double, &single].map(|rows| rows.iter().copied());
        let [of_double, of_single] = rows.clone();
        let Some(time) = time_ratio(of_double, of_single, any_kernel, results.stopping())? else { continue };
        let lights = rows.map(|rows| {
            Repeats::of_images(rows, |image| image.precision.clear(), |row| light.get(&row.image).copied())
        });
        let lighter: Vec<f64> = lights[1].over(&lights[0]).values().iter().map(|ratio| ratio - 1.0).collect();
        let name = format!("{scene}: {estimator}");
        pairs.push(Pair { name, double, single, time, light: t_interval(&lighter, LEVEL) });
    }
    if pairs.is_empty() {
        return Ok(vec![Block::notice("Nothing was rendered in both precisions.")]);
    }
    let dots = pairs
        .iter()
        .filter_map(|pair| Some(DotRow::new(&pair.name, vec![Some(Estimated::from(pair.light?).times(1e4).dot())])));
    let axis =
        Axis::linear("light of single precision over that of double, less 1, in ten-thousandths").including([0.0]);
    let title = Title::new("Is single precision darker or lighter?").with_result(result(&pairs));
    let mut plot = DotPlot::new(title, axis, dots.collect());
    plot.guides = vec![(0.0, "as light".to_string())];
    plot.subtitle = results.run.machine.line();
    plot.caption =
        "Mean over seeds, both precisions with the same random numbers to fewer digits. Bars: 95 %.".to_string();
    let rmse = |rows: &[&Row]| root_of_mean(&values(rows, |row| row.mse));
    let sum = |rows: &[&Row], count: fn(&Row) -> Option<u64>| {
        rows.iter().filter_map(|row| count(row)).sum::<u64>().to_string()
    };
    let table = Block::table("precision", "Single precision beside double", &pairs)
        .column("scene and estimator", |pair| pair.name.clone())
        .estimated("seconds of double / seconds of single", Decimals(2), |pair| Estimated::from(pair.time))
        .number("RMSE, double", Decimals(4), |pair| rmse(&pair.double))
        .number("RMSE, single", Decimals(4), |pair| rmse(&pair.single))
        .estimated("light of single / light of double - 1", Significant(2), |pair| pair.light.map(Estimated::from))
        .column("rays that met nothing, double", |pair| sum(&pair.double, |row| row.escaped_rays))
        .column("rays that met nothing, single", |pair| sum(&pair.single, |row| row.escaped_rays))
        .column("invalid samples, double", |pair| sum(&pair.double, |row| row.invalid_samples))
        .column("invalid samples, single", |pair| sum(&pair.single, |row| row.invalid_samples))
        .end();
    Ok(vec![Block::figure("precision", plot), table])
}

/// The result in a line: a bound that the intervals of all pairs share.
fn result(pairs: &[Pair<'_>]) -> Option<String> {
    let ends = pairs.iter().filter_map(|pair| pair.light).flat_map(|light| [light.interval.low, light.interval.high]);
    let most = ends.map(f64::abs).reduce(f64::max)?;
    Some(format!("Single precision changes the light by at most {} ten-thousandths", short(1e4 * most, 2)))
}
