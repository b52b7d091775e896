//! `pathmark price SCENE --rmse E,E`: what accuracies cost, and with `--pay` whether that was right.

use super::axes::Axes;
use super::output::{print, print_json};
use super::progress::Talk;
use crate::analysis::price::{Price, Renderer};
use crate::analysis::tail::Tail;
use crate::analysis::{Estimate, Interval};
use crate::error::{Error, InputError, Result};
use crate::experiment::{Paid, Pilot, pay};
use crate::lab::Lab;
use crate::measure::{LARGEST_SEED, LARGEST_SPP, Settings};
use clap::Args;
use serde::Serialize;
use std::sync::Arc;

/// Confidence of the intervals.
const LEVEL: f64 = 0.95;

/// `pathmark price cornell --rmse 0.05,0.02,0.01 --pay`
#[derive(Args)]
pub(super) struct Arguments {
    /// A scene of `pathmark list scenes`, or the path of a .toml file
    scene: String,
    /// Goals: root mean squared errors in linear radiance
    #[arg(long, value_name = "E,E,..", value_delimiter = ',', required = true, allow_hyphen_values = true)]
    rmse: Vec<f64>,
    /// Samples per pixel of each seed of the pilot
    #[arg(long, value_name = "N", default_value_t = 16)]
    pilot_spp: u32,
    /// Seeds of the pilot
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(3..=1000))]
    pilot_seeds: u32,
    /// Seed of what is paid for; a second one is the next
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Render each goal with two seeds, and print what it took and gave
    #[arg(long)]
    pay: bool,
    #[command(flatten)]
    axes: Axes,
    /// Print an array of JSON objects
    #[arg(long)]
    json: bool,
}

/// A goal, its price, and what was paid.
#[derive(Serialize)]
struct Row {
    rmse: f64,
    /// Samples per pixel that will be rendered: those of the price, rounded up.
    spp: u32,
    spp_low: f64,
    spp_high: f64,
    seconds: f64,
    seconds_low: f64,
    seconds_high: f64,
    /// Seconds for half the error.
    half_rmse_seconds: Option<f64>,
    paid_rmse: Option<f64>,
    paid_seconds: Option<f64>,
    rmse_ratio: Option<f64>,
    seconds_ratio: Option<f64>,
    /// Of the pilot's values.
    #[serde(flatten)]
    tail: Tail,
    /// Fewest samples that make a whole image.
    #[serde(skip)]
    fewest: u32,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, talk: &Talk) -> Result<()> {
    for goal in &arguments.rmse {
        if !(*goal > 0.0 && goal.is_finite()) {
            let error = InputError::new("rmse", goal.to_string(), "must be a positive number");
            return Err(error.allowed("positive numbers, like 0.05,0.01").into());
        }
    }
    if arguments.seed >= LARGEST_SEED / 2 {
        let error = InputError::new("seed", arguments.seed.to_string(), "belongs to pilots and references");
        return Err(error.allowed(format!("0 to {}", LARGEST_SEED / 2 - 1)).into());
    }
    let settings = arguments.axes.settings(lab, &arguments.scene, arguments.pilot_spp, arguments.seed)?;
    let fewest = lab.prepare(settings.clone())?.fewest_spp();
    let pilot = Pilot { spp: arguments.pilot_spp, seeds: arguments.pilot_seeds };
    let (renderer, tail) = pilot.run(lab, &settings, LEVEL, talk)?;
    let mut rows = Vec::new();
    for &goal in &arguments.rmse {
        rows.push(Row { tail, ..row(lab, arguments, &settings, &renderer, goal, fewest, talk)? });
    }
    if arguments.json { print_json(&rows) } else { print(&table(&settings, arguments, &renderer, &rows)) }
}

fn row(
    lab: &Lab,
    arguments: &Arguments,
    settings: &Settings,
    renderer: &Renderer,
    goal: f64,
    fewest: u32,
    talk: &Talk,
) -> Result<Row> {
    let price = renderer.price(goal).ok_or_else(|| {
        Error::Check(format!("{goal} has no price: the error of {} does not fall with its samples", arguments.scene))
    })?;
    let wanted = whole(price.spp.value, fewest);
    if wanted > f64::from(LARGEST_SPP) {
        let problem = format!("takes {wanted:.0} samples per pixel, more than the {LARGEST_SPP} that there can be");
        return Err(InputError::new("rmse", goal.to_string(), problem).into());
    }
    let spp = wanted as u32;
    let paid = if arguments.pay { Some(pay(lab, settings, spp, talk)?) } else { None };
    Ok(Row::new(&price, (spp, fewest), renderer, paid))
}

/// So many samples, rounded up to whole images.
fn whole(spp: f64, fewest: u32) -> f64 {
    (spp / f64::from(fewest)).ceil().max(1.0) * f64::from(fewest)
}

impl Row {
    /// The next whole image's samples.
    fn whole(&self, spp: f64) -> f64 {
        whole(spp, self.fewest)
    }

    fn new(price: &Price, (spp, fewest): (u32, u32), renderer: &Renderer, paid: Option<Paid>) -> Self {
        let Price { rmse, spp: Estimate { interval: samples, .. }, seconds } = *price;
        // What is rendered is rounded up, and so must be what it is compared with.
        let expected_s = f64::from(spp) * renderer.seconds_per_spp.value;
        let expected = renderer.rmse_after(expected_s).map(|error| error.value);
        Self {
            rmse,
            spp,
            spp_low: samples.low,
            spp_high: samples.high,
            seconds: seconds.value,
            seconds_low: seconds.interval.low,
            seconds_high: seconds.interval.high,
            half_rmse_seconds: renderer.price(0.5 * rmse).map(|half| half.seconds.value),
            paid_rmse: paid.map(|paid| paid.rmse),
            paid_seconds: paid.map(|paid| paid.seconds),
            rmse_ratio: paid.zip(expected).map(|(paid, expected)| paid.rmse / expected),
            seconds_ratio: paid.map(|paid| paid.seconds / expected_s),
            tail: Tail::default(),
            fewest,
        }
    }
}

fn table(settings: &Settings, arguments: &Arguments, renderer: &Renderer, rows: &[Row]) -> String {
    let spec = &settings.spec;
    let Interval { low, high, .. } = renderer.seconds_per_spp.interval;
    let mut lines = vec![
        format!(
            "{}, {} + {}, {}x{}, {} on {}, {} threads",
            settings.scene,
            spec.estimator,
            spec.sampler,
            spec.width,
            spec.height,
            settings.strategy,
            settings.decomposition,
            settings.threads
        ),
        format!(
            "pilot of {} seeds at {} spp: {:.4} s per sample and pixel ({low:.4} to {high:.4}); intervals are of 95 %",
            arguments.pilot_seeds, arguments.pilot_spp, renderer.seconds_per_spp.value
        ),
        format!(
            "one value of one pixel makes up at most {:.2} % of the variance, kurtosis {:.0}",
            100.0 * rows.first().map_or(0.0, |row| row.tail.largest_share),
            rows.first().map_or(0.0, |row| row.tail.kurtosis)
        ),
        format!("{:>9}  {:>8}  {:>21}  {:>9}  {:>19}  {:>10}", "RMSE", "spp", "", "seconds", "", "half of it"),
    ];
    for row in rows {
        lines.push(format!(
            "{:>9}  {:>8}  {:>21}  {:>9.3}  {:>19}  {:>8}",
            row.rmse,
            row.spp,
            format!("({} to {})", row.whole(row.spp_low), row.whole(row.spp_high)),
            row.seconds,
            format!("({:.3} to {:.3})", row.seconds_low, row.seconds_high),
            row.half_rmse_seconds.map_or_else(|| "-".to_string(), |seconds| format!("{seconds:.2} s")),
        ));
        if let [Some(error), Some(seconds), Some(by_error), Some(by_seconds)] =
            [row.paid_rmse, row.paid_seconds, row.rmse_ratio, row.seconds_ratio]
        {
            lines.push(format!(
                "     paid  RMSE {error:.5}, {:+.1} % of what was predicted; {seconds:.3} s, {:+.1} %",
                100.0 * (by_error - 1.0),
                100.0 * (by_seconds - 1.0)
            ));
        }
    }
    lines.join("\n")
}
