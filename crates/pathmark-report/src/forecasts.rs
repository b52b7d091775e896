//! Simulated and predicted schedules as tables and charts: for the figure of an experiment and for the verb `simulate`.

use crate::analysis::speedup::serial_fraction;
use crate::prelude::*;
use crate::simulate::{Contender, DISTURBED, Forecast, Observed, Prediction, agreement, predict};
use std::collections::HashMap;

/// Predicts makespans from the serial run of the same pieces in the same repetition. Leaves out rows with more threads
/// than processors, unless they have a thread for each job.
pub fn predictions(results: &Results, contenders: &[Contender]) -> Result<Vec<Prediction>> {
    let serial = results.serial()?;
    let processors = results.run.machine.processors;
    let costs = serial_costs(results)?;
    let modelled = |row: &Row| row.threads <= processors || row.threads == row.jobs;
    let pairs = serial.in_order(results);
    let runs = pairs.iter().filter(|(row, _)| modelled(row)).filter_map(|(row, serial)| {
        let observed = Observed {
            inflation: inflation(row.cpu_s(), serial.cpu_s()),
            decomposition: row.decomposition.clone(),
            strategy: row.strategy.clone(),
            workers: row.threads,
            makespan_s: row.makespan_s?,
        };
        Some((observed, costs.get(&(serial.cell.as_str(), serial.repetition))?.as_slice()))
    });
    Ok(predict(runs, contenders, processors))
}

/// The cost of each job of the serial runs, by cell and repetition.
pub(super) fn serial_costs(results: &Results) -> Result<HashMap<(&str, u32), Vec<f64>>> {
    let mut costs = HashMap::new();
    for row in results.rows().filter(|row| row.schedule.is_serial()) {
        if let Some(trace) = results.trace(row)? {
            costs.insert((row.cell.as_str(), row.repetition), trace.costs_s());
        }
    }
    Ok(costs)
}

/// CPU time divided by that of the serial run beside it; 1 if the system reported none.
pub fn inflation(own_s: Option<f64>, serial_s: Option<f64>) -> f64 {
    own_s.zip(serial_s).filter(|(own, serial)| *own > 0.0 && *serial > 0.0).map_or(1.0, |(own, serial)| own / serial)
}

/// A finding about the errors, and a table of predicted and measured makespans.
pub fn prediction_blocks(predictions: &[Prediction]) -> Vec<Block> {
    let errors = |ratio: fn(&Prediction) -> Option<f64>| {
        let ratios = predictions.iter().filter_map(ratio);
        agreement(&ratios.map(|ratio| (ratio, 1.0)).collect::<Vec<_>>())
    };
    let all = errors(|p| Some(p.plain_ratio)).zip(errors(|p| Some(p.ratio)));
    let Some((plain, told)) = all else { return Vec::new() };
    let (runs, quiet) = predictions.iter().fold((0, 0), |sum, p| (sum.0 + p.runs, sum.1 + p.undisturbed));
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let block = match errors(|p| p.undisturbed_ratio) {
        None => Block::notice(
            "No run was undisturbed, so there is no telling how well the simulator predicts this machine.",
        ),
        Some(found) => Block::finding(format!(
            "{} of this machine predicted from serial runs: median absolute error {}, worst {}, bias {:+.1} %. That is over the {quiet} of {runs} runs whose CPU time was within {:.0} % of that of the serial run \
             beside them, so that it was the schedule that made their time; over all runs the median is {}, the worst {}. Told besides what CPU time each run took, which is no prediction: median {}, worst {}.",
            counted(predictions.iter().filter(|prediction| prediction.undisturbed > 0).count(), "schedule"),
            percent(found.median_absolute),
            percent(found.worst_absolute),
            100.0 * found.bias,
            100.0 * DISTURBED,
            percent(plain.median_absolute),
            percent(plain.worst_absolute),
            percent(told.median_absolute),
            percent(told.worst_absolute),
        )),
    };
    let off = |ratio: f64| 100.0 * (ratio - 1.0);
    let table = Block::table("predictions", "The simulator predicts this machine", predictions)
        .column("strategy", |p| p.strategy.clone())
        .column("pieces", |p| p.decomposition.clone())
        .column("threads", |p| p.workers.to_string())
        .column("runs", |p| p.runs.to_string())
        .number("predicted ms", Decimals(2), |p| p.predicted_s * 1e3)
        .number("measured ms", Decimals(2), |p| p.measured_s * 1e3)
        .column("undisturbed runs", |p| p.undisturbed.to_string())
        .number("error in undisturbed runs, %", Decimals(1), |p| p.undisturbed_ratio.map(off))
        .number("error in all runs, %", Decimals(1), |p| off(p.plain_ratio))
        .number("error if told the CPU time, %", Decimals(1), |p| off(p.ratio))
        .end();
    vec![block, table]
}

/// The files that the blocks of [`forecast_blocks`] are saved in.
pub const FORECAST_FILES: &[&str] = &[
    "forecast-speedup.svg",
    "forecast-speedup.png",
    "forecast-efficiency.svg",
    "forecast-efficiency.png",
    "forecast-makespan.svg",
    "forecast-makespan.png",
    "forecast.csv",
];

/// Charts of speedup, efficiency and makespan against cores, and a table of all values.
///
/// Graham's bound is drawn only for equal cores, because it holds only for them. Every strategy that is `named` is drawn.
pub fn forecast_blocks(rows: &[Forecast], workload: &str, equal_cores: bool, named: &[String]) -> Vec<Block> {
    let mut blocks = Vec::new();
    let shown = representatives(rows, named);
    let is_whole = rows.iter().all(|row| shown.contains(&row.strategy));
    let left_out = if is_whole {
        ""
    } else {
        " Of strategies that are within a quarter of each other everywhere only one is drawn; the table has all."
    };
    let bound = rows.iter().map(|row| row.share_s * row.workers as f64 / row.longest_s).reduce(f64::max);
    let series = |value: Value| -> Vec<Series> {
        let points = |name: &str| {
            let own = rows.iter().filter(|row| row.strategy == name);
            own.map(|row| Point::new(row.workers as f64, value(row))).collect::<Vec<Point>>()
        };
        Series::by_name(shown.iter().map(|name| (name, points(name))))
    };
    let most = rows.iter().map(|row| row.workers).max().unwrap_or(1);
    // A tick at every number of cores would leave no room for the labels of some powers of two.
    let doubled = std::iter::successors(Some(1), |cores| Some(2 * cores)).take_while(|cores| *cores <= most);
    let ticks: Vec<f64> = doubled.chain([most]).map(|cores| cores as f64).collect();
    let axis = || Axis::log("cores").ticks_at(ticks.clone());
    let mut speedup = LineChart::new("Forecast: speedup", axis(), Axis::log("speedup"), series(|row| row.speedup));
    speedup.overlays = vec![Overlay::guide("one per core", Curve::Line { intercept: 0.0, slope: 1.0 })];
    if let Some(bound) = bound {
        speedup.overlays.push(Overlay::guide("work / longest job", Curve::Line { intercept: bound, slope: 0.0 }));
    }
    let efficiency_axis = Axis::linear("speedup per core").including([0.0, 1.0]);
    let mut efficiency = LineChart::new("Forecast: efficiency", axis(), efficiency_axis, series(|row| row.efficiency));
    efficiency.overlays = vec![Overlay::guide("ideal: 1", Curve::Line { intercept: 1.0, slope: 0.0 })];
    let mut makespans = series(|row| row.makespan_s);
    makespans.extend(bounds(rows, makespans.len(), equal_cores));
    let makespan = LineChart::new("Forecast: makespan and its bounds", axis(), Axis::log("seconds"), makespans);
    let charts = [("forecast-speedup", speedup), ("forecast-efficiency", efficiency), ("forecast-makespan", makespan)];
    for (stem, mut chart) in charts {
        chart.subtitle = workload.to_string();
        chart.caption = format!("Simulated from the jobs of one serial run.{left_out}");
        blocks.push(Block::figure(stem, chart));
    }
    blocks.push(
        Block::table("forecast", "Forecast", rows)
            .column("strategy", |row| row.strategy.clone())
            .column("cores", |row| row.workers.to_string())
            .number("makespan, s", Decimals(5), |row| row.makespan_s)
            .number("speedup", Decimals(2), |row| row.speedup)
            .number("efficiency", Decimals(3), |row| row.efficiency)
            .number("serial fraction (Karp and Flatt)", Decimals(4), |row| serial_fraction(row.speedup, row.workers))
            .number("work / cores, s", Decimals(5), |row| row.share_s)
            .number("longest job, s", Decimals(5), |row| row.longest_s)
            .number("Graham's bound, s", Decimals(5), |row| row.greedy_s)
            .end(),
    );
    blocks
}

/// The value of a row that a line of a chart shows.
type Value = fn(&Forecast) -> f64;

/// Lower bounds of every makespan, and the upper bound of greedy schedules, as lines without intervals.
fn bounds(rows: &[Forecast], first: usize, equal_cores: bool) -> Vec<Series> {
    let values: [(&str, Value); 3] = [
        ("bound: work / cores", |row| row.share_s),
        ("bound: longest job", |row| row.longest_s),
        ("Graham: any greedy schedule", |row| row.greedy_s),
    ];
    // The bounds are the same for every strategy, so the rows of one that ran on all numbers of workers suffice.
    let most = rows.iter().map(|row| row.workers).max();
    let name = rows.iter().find(|row| Some(row.workers) == most).map(|row| row.strategy.as_str());
    let own: Vec<&Forecast> = rows.iter().filter(|row| Some(row.strategy.as_str()) == name).collect();
    let line = |(index, (name, value)): (usize, (&str, Value))| {
        let points = own.iter().map(|row| Point::new(row.workers as f64, value(row))).collect();
        Series::new(name, Look::nth(first + index), points)
    };
    values.into_iter().take(if equal_cores { 3 } else { 2 }).enumerate().map(line).collect()
}

/// The strategies that a chart shows: those that are `named`, and of others whose speedups are within a quarter of each
/// other everywhere, the first.
fn representatives(rows: &[Forecast], named: &[String]) -> Vec<String> {
    let mut names: Vec<&str> = rows.iter().map(|row| row.strategy.as_str()).collect();
    names.dedup();
    let speedups =
        |name: &str| rows.iter().filter(|row| row.strategy == name).map(|row| row.speedup).collect::<Vec<f64>>();
    let most = names.iter().map(|name| speedups(name).len()).max().unwrap_or(0);
    let mut shown: Vec<(String, Vec<f64>)> = Vec::new();
    for name in names {
        let own = speedups(name);
        let alike = |other: &Vec<f64>| other.iter().zip(&own).all(|(a, b)| (a / b - 1.0).abs() < 0.25);
        // A strategy with a fixed number of workers, such as serial, has no line, but a point if it is named.
        let stands_out = || own.len() == most && !shown.iter().any(|(_, other)| alike(other));
        if named.iter().any(|wanted| wanted == name) || stands_out() {
            shown.push((name.to_string(), own));
        }
    }
    shown.into_iter().map(|(name, _)| name).collect()
}
