//! What other machines would make of the jobs that were measured here, and how well this machine is predicted.

use crate::analysis::quantile::median;
use crate::error::Result;
use crate::experiment::read_calibration;
use crate::measure::{Record, THREAD_PER_ROW};
use crate::plot::style::Look;
use crate::plot::{Axis, Curve, LineChart, Overlay, Point, Series};
use crate::report::block::{Block, Table};
use crate::report::results::Results;
use crate::simulate::{Contender, Forecast, Hardware, Observed, Prediction, agreement, contenders, forecast, predict};
use std::collections::BTreeMap;

/// Cores of the machines that are looked at.
const CORES: [usize; 12] = [1, 2, 4, 8, 16, 32, 64, 128, 256, 384, 512, 768];

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let path = results.folder.join("calibration.csv");
    if !path.is_file() {
        return Ok(vec![Block::Finding("There is no calibration.csv, so nothing can be simulated.".to_string())]);
    }
    let contenders = contenders(&read_calibration(&path)?)?;
    let mut blocks = prediction_blocks(&predictions(results, &contenders)?);
    let serial = |record: &&Record| record.strategy == "serial" && record.decomposition == "rows";
    let rows: Vec<&Record> = results.records.iter().filter(serial).collect();
    if let Some(record) = Results::typical(&rows)
        && let Some(trace) = results.trace(record)?
    {
        let costs = trace.costs_s();
        let mut all = contenders;
        all.push(Contender::longest_first());
        let rows = forecast(&costs, &all, &CORES, &Hardware::default());
        let of = format!("{}x{}, {} spp, {} rows", record.width, record.height, record.spp, costs.len());
        blocks.extend(claim(&rows, &costs));
        blocks.extend(forecast_blocks(&rows, &format!("{}, {of}, simulated", record.scene)));
    }
    Ok(blocks)
}

/// The makespans of all rows, predicted from the serial run of the same pieces in the same repetition.
pub(crate) fn predictions(results: &Results, contenders: &[Contender]) -> Result<Vec<Prediction>> {
    let key = |record: &Record| {
        let size = format!("{}x{} {}", record.width, record.height, record.spp);
        format!("{} {} {} {size} {}", record.scene_hash, record.estimator, record.sampler, record.decomposition)
    };
    let mut costs: BTreeMap<(String, u32), Vec<f64>> = BTreeMap::new();
    for record in results.records.iter().filter(|record| record.strategy == "serial") {
        if let Some(trace) = results.trace(record)? {
            costs.insert((key(record), record.repetition), trace.costs_s());
        }
    }
    let runs = results.records.iter().filter(|record| record.strategy != "serial").filter_map(|record| {
        let observed = Observed {
            decomposition: record.decomposition.clone(),
            strategy: record.strategy.clone(),
            workers: record.threads,
            makespan_s: record.makespan_s?,
        };
        Some((observed, costs.get(&(key(record), record.repetition))?.as_slice()))
    });
    Ok(predict(runs, contenders))
}

/// Predicted against measured, and the errors in a sentence.
pub(crate) fn prediction_blocks(predictions: &[Prediction]) -> Vec<Block> {
    let pairs: Vec<(f64, f64)> = predictions.iter().map(|prediction| (prediction.ratio, 1.0)).collect();
    let Some(agreement) = agreement(&pairs) else { return Vec::new() };
    let row = |prediction: &Prediction| {
        vec![
            prediction.strategy.clone(),
            prediction.decomposition.clone(),
            prediction.workers.to_string(),
            prediction.runs.to_string(),
            format!("{:.2}", prediction.predicted_s * 1e3),
            format!("{:.2}", prediction.measured_s * 1e3),
            format!("{:+.1} %", 100.0 * (prediction.ratio - 1.0)),
        ]
    };
    let columns =
        ["strategy", "pieces", "threads", "runs", "predicted ms", "measured ms", "error (median of paired ratios)"];
    let title = "The simulator predicts this machine".to_string();
    let rows = predictions.iter().map(row).collect();
    vec![
        Block::Finding(format!(
            "{} schedules of this machine predicted from serial runs: median absolute error {:.1} %, worst {:.1} %, bias {:+.1} %.",
            predictions.len(),
            100.0 * agreement.median_absolute,
            100.0 * agreement.worst_absolute,
            100.0 * agreement.bias,
        )),
        Block::Table { stem: "predictions", table: Table { title, columns: columns.map(String::from).to_vec(), rows } },
    ]
}

/// Report A's "1/h times faster" in numbers.
fn claim(rows: &[Forecast], costs: &[f64]) -> Option<Block> {
    let at = |cores: usize| rows.iter().find(|row| row.strategy == "thread-per-job" && row.workers == cores);
    let (two, sixteen, all) = (at(2)?, at(16)?, at(768)?);
    let best = rows.iter().filter(|row| row.workers == 768).max_by(|a, b| a.speedup.total_cmp(&b.speedup))?;
    let mean = costs.iter().sum::<f64>() / costs.len() as f64;
    let longest_over_median = all.longest_s / median(costs)?;
    Some(Block::Finding(format!(
        "{THREAD_PER_ROW} (a thread for each of {} rows) would be {:.2} times as fast as serial on 2 cores, {:.1} times on 16 and {:.0} times on 768, not 768: the longest row takes {:.2} times the mean ({:.2} times the \
         median), which alone allows no more than {:.0}, and threads are started one after the other. The best of all schedules on 768 cores, {}, reaches {:.0}.",
        costs.len(),
        two.speedup,
        sixteen.speedup,
        all.speedup,
        all.longest_s / mean,
        longest_over_median,
        costs.iter().sum::<f64>() / all.longest_s,
        best.strategy,
        best.speedup,
    )))
}

/// Speedup and efficiency against cores, and all numbers as a table.
pub(crate) fn forecast_blocks(rows: &[Forecast], workload: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let shown = representatives(rows);
    let bound = rows.iter().map(|row| row.share_s * row.workers as f64 / row.longest_s).reduce(f64::max);
    let series = |value: fn(&Forecast) -> f64| -> Vec<Series> {
        let points = |name: &str| {
            let own = rows.iter().filter(|row| row.strategy == name);
            own.map(|row| Point::new(row.workers as f64, value(row))).collect()
        };
        shown
            .iter()
            .enumerate()
            .map(|(index, name)| Series::new(name.as_str(), Look::nth(index), points(name)))
            .collect()
    };
    let mut ticks: Vec<f64> = rows.iter().map(|row| row.workers as f64).collect();
    ticks.sort_by(f64::total_cmp);
    ticks.dedup();
    let axis = || Axis::log("cores").ticks_at(ticks.clone());
    let mut speedup = LineChart::new("Forecast: speedup", axis(), Axis::log("speedup"), series(|row| row.speedup));
    speedup.overlays = vec![Overlay::guide("one per core", Curve::Line { intercept: 0.0, slope: 1.0 })];
    if let Some(bound) = bound {
        speedup.overlays.push(Overlay::guide("work / longest job", Curve::Line { intercept: bound, slope: 0.0 }));
    }
    let efficiency_axis = Axis::linear("speedup per core").including([0.0, 1.0]);
    let mut efficiency = LineChart::new("Forecast: efficiency", axis(), efficiency_axis, series(|row| row.efficiency));
    efficiency.overlays = vec![Overlay::guide("ideal: 1", Curve::Line { intercept: 1.0, slope: 0.0 })];
    for (stem, mut chart) in [("forecast-speedup", speedup), ("forecast-efficiency", efficiency)] {
        chart.subtitle = workload.to_string();
        chart.caption = "Simulated from the jobs of one serial run. Strategies that hand out by the same rule coincide but for what handing out costs; one of each is drawn.".to_string();
        blocks.push(Block::Figure { stem, figure: Box::new(chart) });
    }
    let columns = [
        "strategy",
        "cores",
        "makespan, s",
        "speedup",
        "efficiency",
        "work / cores, s",
        "longest job, s",
        "Graham's bound, s",
    ];
    let row = |row: &Forecast| {
        let seconds = |value: f64| format!("{value:.5}");
        vec![
            row.strategy.clone(),
            row.workers.to_string(),
            seconds(row.makespan_s),
            format!("{:.2}", row.speedup),
            format!("{:.3}", row.efficiency),
            seconds(row.share_s),
            seconds(row.longest_s),
            seconds(row.greedy_s),
        ]
    };
    let table = Table {
        title: "Forecast".to_string(),
        columns: columns.map(String::from).to_vec(),
        rows: rows.iter().map(row).collect(),
    };
    blocks.push(Block::Table { stem: "forecast", table });
    blocks
}

/// The strategies that a chart shows: the first of those whose speedups are alike everywhere, to within two percent.
fn representatives(rows: &[Forecast]) -> Vec<String> {
    let mut names: Vec<&str> = rows.iter().map(|row| row.strategy.as_str()).collect();
    names.dedup();
    let speedups =
        |name: &str| rows.iter().filter(|row| row.strategy == name).map(|row| row.speedup).collect::<Vec<f64>>();
    let mut shown: Vec<(String, Vec<f64>)> = Vec::new();
    for name in names {
        let own = speedups(name);
        let alike = |other: &Vec<f64>| other.iter().zip(&own).all(|(a, b)| (a / b - 1.0).abs() < 0.02);
        // A strategy that has one number of workers whatever is asked, as serial has, is no line.
        if own.len() > 1 && !shown.iter().any(|(_, other)| alike(other)) {
            shown.push((name.to_string(), own));
        }
    }
    shown.into_iter().map(|(name, _)| name).collect()
}
