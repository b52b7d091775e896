//! Error against samples per pixel on two logarithmic axes. Independent samples fall along a line of slope -1/2.

use crate::analysis::jackknife::SeedCurves;
use crate::analysis::slope::{PowerLaw, power_law};
use crate::contenders::{curves_by, one_per_seed};
use crate::estimated::root_of_mean;
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
    let (mut series, mut overlays, mut slopes, mut lines) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (index, (name, rows)) in results.by(|row| results.image_name(row)).into_iter().enumerate() {
        let at_spp = group(rows.iter().copied(), |row| row.spp).into_iter().filter_map(|(spp, rows)| {
            let mse = one_per_seed(&rows, values.mse());
            let error = Estimated::rmse(&mse);
            let other = root_of_mean(&one_per_seed(&rows, values.other().mse()));
            (!mse.is_empty()).then(|| Line { image: name.clone(), spp, seeds: mse.len(), error, other })
        });
        let own: Vec<Line> = at_spp.collect();
        let curves: Vec<_> = curves_by(&rows, values.mse()).into_iter().map(|(curve, _)| curve).collect();
        let fit = SeedCurves::of_errors(&curves).and_then(|curves| power_law(&curves, LEVEL));
        if let Some(fit) = fit.filter(|_| own.len() >= FEWEST_POINTS) {
            let slope = fit.exponent.value;
            let curve = Curve::Power { scale: libm::exp(fit.log_scale), exponent: slope };
            overlays.push(Overlay::fit(format!("fit: slope {slope:.3}"), curve, index));
            slopes.push((name.clone(), fit));
        }
        let points = own.iter().map(|line| line.error.above(f64::from(line.spp))).collect();
        series.push(Series::new(name, Look::nth(index), points).scattered());
        lines.extend(own);
    }
    let first = lines.first().map(|line| (f64::from(line.spp), line.error.value));
    if let Some(curve) = first.and_then(|point| Curve::power_through(point, -0.5)) {
        overlays.insert(0, Overlay::guide("slope -1/2", curve));
    }
    let steepest = slopes.iter().min_by(|a, b| a.1.exponent.value.total_cmp(&b.1.exponent.value));
    let mut chart = LineChart::new(
        Title::new("Error against samples per pixel").with_result(result(&slopes)),
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
    let findings = steepest.iter().map(|own| steepest_finding(own, slopes.len())).chain(bent(&slopes));
    let fits = (!slopes.is_empty()).then(|| fits(&slopes));
    Ok([Block::figure("rmse-against-spp", chart)].into_iter().chain(findings).chain(fits).chain([table]).collect())
}

/// The name of a curve and its fitted power law.
type Slope = (String, PowerLaw);

/// The exponent of independent samples.
const INDEPENDENT: f64 = -0.5;

/// The result in a line: the curve that falls fastest, if one falls faster than independent samples do.
fn result(slopes: &[Slope]) -> Option<String> {
    let of = |is_meant: fn(&Interval) -> bool| slopes.iter().filter(move |(_, fit)| is_meant(&fit.exponent.interval));
    let falls = |(name, fit): &Slope, how: &str| {
        let with = if slopes.len() > 1 { format!(" with {name}") } else { String::new() };
        format!("The error falls {how}{with}: as samples to the power {:.2}, not -1/2", fit.exponent.value)
    };
    let faster = of(|interval| interval.high < INDEPENDENT);
    let slower = of(|interval| interval.low > INDEPENDENT);
    let steepest = faster.min_by(|a, b| a.1.exponent.value.total_cmp(&b.1.exponent.value));
    let flattest = slower.max_by(|a, b| a.1.exponent.value.total_cmp(&b.1.exponent.value));
    if slopes.is_empty() {
        return None;
    }
    Some(match (steepest, flattest) {
        (Some(own), _) if slopes.len() > 1 => falls(own, "fastest"),
        (Some(own), _) => falls(own, "faster"),
        (None, Some(own)) => falls(own, "more slowly"),
        (None, None) => "Half the error takes four times the samples: no slope is told apart from -1/2".to_string(),
    })
}

/// A finding about the steepest of some curves.
fn steepest_finding((name, fit): &Slope, count: usize) -> Block {
    let (slope, interval) = (fit.exponent.value, fit.exponent.interval);
    let verdict = if interval.contains(INDEPENDENT) { "contains" } else { "does not contain" };
    let of_all = if count > 1 { format!(", the steepest of {count}") } else { String::new() };
    Block::finding(format!(
        "{name}{of_all}: RMSE falls as spp to the power {slope:.3}; the 95 % interval over {} seeds, {:.3} to {:.3}, {verdict} -1/2. \
         Halving the error takes {:.2} times the samples ({:.2} to {:.2}).",
        fit.seeds,
        interval.low,
        interval.high,
        samples_for_half(slope),
        samples_for_half(interval.low),
        samples_for_half(interval.high),
    ))
}

fn samples_for_half(exponent: f64) -> f64 {
    libm::pow(0.5, 1.0 / exponent)
}

/// A finding about curves that are no lines.
fn bent(slopes: &[Slope]) -> Option<Block> {
    let count = slopes.iter().filter(|(_, fit)| fit.lacks_fit()).count();
    (count > 0).then(|| {
        let (whose, them) = match slopes.len() {
            1 => ("The points".to_string(), "it"),
            all => (format!("The points of {count} of {all} curves"), "them"),
        };
        Block::finding(format!(
            "{whose} do not lie on a line: the exponent changes along the curve by more than its interval, so no one exponent describes {them}."
        ))
    })
}

fn fits(slopes: &[Slope]) -> Block {
    let remark = |fit: &PowerLaw| if fit.lacks_fit() { "the points do not lie on a line" } else { "" };
    Block::table("rmse-slopes", "Power of the samples with which the error falls", slopes)
        .column("image", |(name, _)| name.clone())
        .estimated("exponent", Decimals(3), |(_, fit)| Estimated::from(fit.exponent))
        .number("times the samples for half the error", Decimals(2), |(_, fit)| samples_for_half(fit.exponent.value))
        .column("seeds", |(_, fit)| fit.seeds.to_string())
        .column("remark", |(_, fit)| remark(fit).to_string())
        .end()
}
