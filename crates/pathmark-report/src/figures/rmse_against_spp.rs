//! Error against samples per pixel on two logarithmic axes. Independent samples fall along a line of slope -1/2.

use crate::analysis::jackknife::SeedCurves;
use crate::analysis::mse::over_seeds;
use crate::analysis::slope::power_law;
use crate::contenders::{curves_by, one_per_seed, root_of_mean};
use crate::prelude::*;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Options {
    /// The values whose error is drawn.
    values: Values,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Values {
    /// Linear radiance.
    #[default]
    Linear,
    /// Display values: clamped to 0 to 1, gamma 2.2.
    Display,
}

impl Values {
    fn mse(self) -> fn(&Row) -> Option<f64> {
        match self {
            Self::Linear => |row| row.mse,
            Self::Display => |row| row.mse_display,
        }
    }

    fn other(self) -> Self {
        match self {
            Self::Linear => Self::Display,
            Self::Display => Self::Linear,
        }
    }

    fn heading(self) -> &'static str {
        match self {
            Self::Linear => "RMSE, linear",
            Self::Display => "RMSE, display",
        }
    }

    fn axis(self) -> &'static str {
        match self {
            Self::Linear => "RMSE, linear radiance",
            Self::Display => "RMSE, display values (0 to 1, gamma 2.2)",
        }
    }
}

/// A line has a slope from this many numbers of samples on: fewer hardly show whether the points lie on a line. Few
/// seeds need no such limit, because Student's quantile widens their interval.
const FEWEST_POINTS: usize = 4;

/// The error of an image at some number of samples.
struct Line {
    image: String,
    spp: u32,
    seeds: usize,
    error: Estimated,
    /// RMSE of the values that are not drawn.
    other: f64,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Options { values } = options(&results.definition, "rmse-against-spp")?;
    let (mut series, mut overlays, mut findings, mut lines) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (index, (name, rows)) in results.by(|row| results.image_name(row)).into_iter().enumerate() {
        let at_spp = group(rows.iter().copied(), |row| row.spp).into_iter().filter_map(|(spp, rows)| {
            let mse = one_per_seed(&rows, values.mse());
            let interval = over_seeds(&mse, LEVEL).map(|error| error.rmse.interval);
            let error = Estimated { count: Some(mse.len()), ..Estimated::of(root_of_mean(&mse), interval) };
            let other = root_of_mean(&one_per_seed(&rows, values.other().mse()));
            (!mse.is_empty()).then(|| Line { image: name.clone(), spp, seeds: mse.len(), error, other })
        });
        let own: Vec<Line> = at_spp.collect();
        let curves: Vec<_> = curves_by(&rows, values.mse()).into_iter().map(|(curve, _)| curve).collect();
        let fit = SeedCurves::of_errors(&curves).and_then(|curves| power_law(&curves, LEVEL));
        if let Some(fit) = fit.filter(|_| own.len() >= FEWEST_POINTS) {
            let (slope, interval) = (fit.exponent.value, fit.exponent.interval);
            let curve = Curve::Power { scale: libm::exp(fit.log_scale), exponent: slope };
            let seeds = counted(fit.seeds, "seed");
            let label = format!("fit: slope {slope:.3}, {seeds}\n95 % {:.3} to {:.3}", interval.low, interval.high);
            overlays.push(Overlay::fit(label, curve, index));
            let verdict = if interval.contains(-0.5) { "contains" } else { "does not contain" };
            findings.push(Block::finding(format!(
                "{name}: RMSE falls as spp to the power {slope:.3}; the 95 % interval over {} seeds, {:.3} to {:.3}, {verdict} -1/2. \
                 Half the error therefore takes {:.2} times the samples ({:.2} to {:.2}).",
                fit.seeds,
                interval.low,
                interval.high,
                libm::pow(0.5, 1.0 / slope),
                libm::pow(0.5, 1.0 / interval.low),
                libm::pow(0.5, 1.0 / interval.high),
            )));
            if fit.lacks_fit() {
                findings.push(Block::finding(format!(
                    "{name}: the points do not lie on a line (the exponent changes along it by more than its interval), so no one exponent describes them."
                )));
            }
        }
        let points = own.iter().map(|line| line.error.above(f64::from(line.spp))).collect();
        series.push(Series::new(name, Look::nth(index), points).scattered());
        lines.extend(own);
    }
    let first = lines.first().map(|line| (f64::from(line.spp), line.error.value));
    if let Some(curve) = first.and_then(|point| Curve::power_through(point, -0.5)) {
        overlays.insert(0, Overlay::guide("slope -1/2", curve));
    }
    let mut chart = LineChart::new(
        "Error against samples per pixel",
        Axis::log("samples per pixel").ticks_at(results.rows().map(|row| f64::from(row.spp))),
        Axis::log(values.axis()),
        series,
    );
    chart.subtitle = results.workload();
    chart.caption =
        "Bars: 95 % interval over seeds. Squared errors are free of the references' noise (cross form).".to_string();
    chart.overlays = overlays;
    chart.dodge = 6.0;
    let table = Block::table("rmse-by-spp", "Error by samples per pixel", lines)
        .column("image", |line| line.image.clone())
        .column("spp", |line| line.spp.to_string())
        .column("seeds", |line| line.seeds.to_string())
        .estimated(values.heading(), Decimals(5), |line| line.error)
        .number(values.other().heading(), Decimals(5), |line| line.other)
        .end();
    Ok([Block::figure("rmse-against-spp", chart)].into_iter().chain(findings).chain([table]).collect())
}
