//! What single precision buys and costs: time, error, light, and what went wrong, beside double precision.

use crate::analysis::Estimate;
use crate::analysis::mean::t_interval;
use crate::error::Result;
use crate::image_io::Image;
use crate::measure::Record;
use crate::plot::{Axis, Dot, DotPlot, Row};
use crate::report::block::{Block, Table};
use crate::report::results::{LEVEL, Results};
use std::collections::BTreeMap;

const DOUBLE: &str = "f64";
const SINGLE: &str = "f32";

/// Both images of a seed.
type Pair = BTreeMap<String, f64>;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let mut light: BTreeMap<(String, String), BTreeMap<u64, Pair>> = BTreeMap::new();
    for (record, image) in results.kept_images(|record| record.kernel_fallback.is_empty())? {
        let seeds = light.entry((record.scene.clone(), record.estimator.clone())).or_default();
        seeds.entry(record.seed).or_default().insert(record.precision.clone(), brightness(&image));
    }
    let (mut rows, mut dots) = (Vec::new(), Vec::new());
    for ((scene, estimator), seeds) in &light {
        let of = |record: &Record, precision: &str| {
            record.scene == *scene && record.estimator == *estimator && record.precision == precision
        };
        let Some(time) = results.kind_ratio(|record| of(record, DOUBLE), |record| of(record, SINGLE)) else { continue };
        let difference = difference(seeds);
        let name = format!("{scene}: {estimator}");
        if let Some(Estimate { value, interval }) = difference {
            let dot = Dot { value: 1e4 * value, interval: Some((1e4 * interval.low, 1e4 * interval.high)) };
            dots.push(Row { name: name.clone(), dots: vec![Some(dot)] });
        }
        let both = |of_precision: &dyn Fn(&str) -> String| [of_precision(DOUBLE), of_precision(SINGLE)];
        let sum = |precision: &str, count: fn(&Record) -> Option<u64>| {
            let counts = results.records.iter().filter(|record| of(record, precision)).filter_map(count);
            counts.sum::<u64>().to_string()
        };
        let rmse = |precision: &str| {
            let errors: Vec<f64> =
                results.records.iter().filter(|record| of(record, precision)).filter_map(|record| record.mse).collect();
            format!("{:.4}", (errors.iter().sum::<f64>() / errors.len() as f64).sqrt())
        };
        let mut row = vec![name, format!("{:.2} ({:.2} to {:.2})", time.value, time.interval.low, time.interval.high)];
        row.extend(both(&rmse));
        row.push(difference.map_or_else(
            || "-".to_string(),
            |e| format!("{:+.1e} ({:+.1e} to {:+.1e})", e.value, e.interval.low, e.interval.high),
        ));
        row.extend(both(&|precision| sum(precision, |record| record.escaped)));
        row.extend(both(&|precision| sum(precision, |record| record.invalid_samples)));
        rows.push(row);
    }
    if rows.is_empty() {
        return Ok(vec![Block::Finding("Nothing was rendered in both precisions.".to_string())]);
    }
    let axis =
        Axis::linear("light of single precision over that of double, less 1, in ten-thousandths").including([0.0]);
    let mut plot = DotPlot::new("Is single precision darker or lighter?", axis, dots);
    plot.guides = vec![(0.0, "as light".to_string())];
    plot.subtitle = results.machine_line();
    plot.caption =
        "Mean over seeds, both precisions with the same random numbers to fewer digits. Bars: 95 %.".to_string();
    let columns = [
        "",
        "seconds of double / seconds of single (95 %)",
        "RMSE, double",
        "RMSE, single",
        "light of single / light of double - 1 (95 %)",
        "rays that met nothing, double",
        "single",
        "invalid samples, double",
        "single",
    ];
    let title = "Single precision beside double".to_string();
    Ok(vec![
        Block::Figure { stem: "precision", figure: Box::new(plot) },
        Block::Table { stem: "precision", table: Table { title, columns: columns.map(String::from).to_vec(), rows } },
    ])
}

fn brightness(image: &Image) -> f64 {
    image.mean().iter().sum()
}

/// The mean over seeds of how much lighter single precision is, relatively.
fn difference(seeds: &BTreeMap<u64, Pair>) -> Option<Estimate> {
    let ratios: Vec<f64> =
        seeds.values().filter_map(|pair| Some(pair.get(SINGLE)? / pair.get(DOUBLE)? - 1.0)).collect();
    t_interval(&ratios, LEVEL)
}
