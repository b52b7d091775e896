//! Simulated and predicted schedules as tables and charts: for the figure of an experiment and for the verb `simulate`.

use crate::analysis::crossed::Crossed;
use crate::analysis::speedup::serial_fraction;
use crate::plot::number::{between, short};
use crate::prelude::*;
use crate::simulate::{
    BusyRatio, Contender, DISTURBED, Forecast, LONGEST_FIRST, Observed, Prediction, RelativeErrors, WorkInflation,
    busy_ratios, predict, relative_errors,
};
use std::collections::HashMap;

/// Predictions of this machine's runs, and the ratios of their busy times to the serial runs' beside them.
pub struct Predicted {
    pub predictions: Vec<Prediction>,
    pub ratios: Vec<BusyRatio>,
}

impl Predicted {
    /// Predicts runs from the costs of the jobs of the serial runs beside them.
    pub fn of(runs: &[(Observed, Vec<f64>)], contenders: &[Contender], processors: usize) -> Self {
        let ratios = busy_ratios(runs.iter().map(|(run, _)| run));
        let runs = runs.iter().map(|(run, costs)| (run.clone(), costs.as_slice()));
        Self { predictions: predict(runs, contenders, processors), ratios }
    }
}

/// Predicts makespans from the serial run of the same pieces in the same repetition. Leaves out rows with more threads
/// than processors, unless they have a thread for each job.
pub fn predictions(results: &Results, contenders: &[Contender]) -> Result<Predicted> {
    let serial = results.serial()?;
    let processors = results.run.machine.processors;
    let costs = serial_costs(results)?;
    let modelled = |row: &Row| row.threads <= processors || row.threads == row.jobs;
    let pairs = serial.in_order(results);
    let runs = pairs.iter().filter(|(row, _)| modelled(row)).filter_map(|(row, serial)| {
        let has_own_processors = row.threads <= processors;
        let observed = Observed {
            inflation: inflation(row.cpu_s(), serial.cpu_s()),
            decomposition: row.decomposition.clone(),
            strategy: row.strategy.clone(),
            workers: row.threads,
            repetition: row.repetition,
            makespan_s: row.makespan_s?,
            busy: row
                .busy_sum_s
                .zip(serial.busy_sum_s)
                .filter(|_| has_own_processors)
                .map(|(own, serial)| own / serial),
        };
        Some((observed, costs.get(&(serial.cell.as_str(), serial.repetition))?.clone()))
    });
    Ok(Predicted::of(&runs.collect::<Vec<_>>(), contenders, processors))
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

/// All runs, in words.
pub(super) fn all_runs(runs: usize) -> String {
    if runs == 1 { "the only run".to_string() } else { format!("all {runs} runs") }
}

/// Findings about the errors and about work inflation, and a table of predicted and measured makespans.
pub fn prediction_blocks(Predicted { predictions, ratios }: &Predicted) -> Vec<Block> {
    let errors = |ratio: fn(&Prediction) -> Option<f64>| {
        let ratios = predictions.iter().filter_map(ratio);
        relative_errors(&ratios.map(|ratio| (ratio, 1.0)).collect::<Vec<_>>()).map(|found| in_words(&found))
    };
    let Some(all) = errors(|p| Some(p.plain_ratio)) else { return Vec::new() };
    let runs: usize = predictions.iter().map(|prediction| prediction.runs).sum();
    let quiet: usize = predictions.iter().map(|prediction| prediction.undisturbed).sum();
    let first = format!(
        "{} of this machine predicted from serial runs. Over {}: {all}.",
        counted(predictions.len(), "schedule"),
        all_runs(runs),
    );
    let quietly = format!(
        "Over {} whose CPU time was within {:.0} % of the serial run's, so that the schedule made the time",
        counted(quiet, "run"),
        100.0 * DISTURBED
    );
    let others = [
        ("With the work inflation of the other repetitions", errors(|p| p.modelled_ratio)),
        (&quietly, errors(|p| p.undisturbed_ratio)),
        ("Told each run's own CPU time, which is no prediction", errors(|p| Some(p.ratio))),
    ];
    let others = others.into_iter().filter_map(|(subject, found)| Some(format!("{subject}: {}.", found?)));
    let told = std::iter::once(first).chain(others).collect::<Vec<String>>().join(" ");
    let off = |ratio: f64| 100.0 * (ratio - 1.0);
    let table = Block::table("predictions", "The simulator predicts this machine", predictions)
        .column("strategy", |p| p.strategy.clone())
        .column("pieces", |p| p.decomposition.clone())
        .column("threads", |p| p.workers.to_string())
        .column("runs", |p| p.runs.to_string())
        .number("predicted ms", Decimals(2), |p| p.predicted_s * 1e3)
        .number("measured ms", Decimals(2), |p| p.measured_s * 1e3)
        .number("error in all runs, %", Decimals(1), |p| off(p.plain_ratio))
        .number("error with work inflation, %", Decimals(1), |p| p.modelled_ratio.map(off))
        .column("undisturbed runs", |p| p.undisturbed.to_string())
        .number("error in undisturbed runs, %", Decimals(1), |p| p.undisturbed_ratio.map(off))
        .number("error if told the CPU time, %", Decimals(1), |p| off(p.ratio))
        .end();
    std::iter::once(Block::finding(told)).chain(inflation_block(ratios)).chain([table]).collect()
}

/// Errors of predictions, in words.
pub(super) fn in_words(found: &RelativeErrors) -> String {
    format!(
        "median absolute error {:.1} %, largest {:.1} %, bias {:+.1} %",
        100.0 * found.median_absolute,
        100.0 * found.worst_absolute,
        100.0 * found.bias
    )
}

/// A finding about the work inflation at the most workers, if there were several.
fn inflation_block(ratios: &[BusyRatio]) -> Option<Block> {
    let inflation = WorkInflation::of(ratios, None);
    let (workers, factors) = inflation.largest().filter(|(workers, _)| *workers > 1)?;
    let told = Estimated::typical(factors, Stopping::Fixed)?;
    let confidence = told.interval.map(|own| format!("{:.1} % confidence", own.percent()));
    Some(Block::finding(format!(
        "Work inflation: with {} busy, the jobs took {}{} times as long as in the serial run of the same repetition \
         ({}). A prediction without this factor is too fast by it. The forecasts leave it out: in \
         them, a busy neighbour slows no core.",
        counted(workers, "thread"),
        short(told.value, 3),
        between(told.bar(), 3),
        joined(confidence.into_iter().chain([counted(factors.len(), "repetition")])),
    )))
}

impl From<Crossed> for Estimated {
    fn from(Crossed { value, interval }: Crossed) -> Self {
        Self::of(value, interval)
    }
}

/// The sentence about the band of a forecast, from its numbers of serial runs and calibrations.
pub(super) fn band(traces: usize, calibrations: usize) -> String {
    let sources = match (traces > 1, calibrations > 1) {
        (true, true) => "",
        (true, false) => " The band leaves out how well the costs of handing out are known: there is one calibration.",
        (false, true) => " The band leaves out how much serial runs differ: there is one.",
        (false, false) => {
            return format!(
                "From {} and {}: no interval.",
                counted(traces, "serial run"),
                counted(calibrations, "calibration")
            );
        }
    };
    format!(
        "Band: {:.0} % confidence, from {} and {}.{sources}",
        100.0 * LEVEL,
        counted(traces, "serial run"),
        counted(calibrations, "calibration")
    )
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
    let series = |value: fn(&Forecast) -> Option<Crossed>| -> Vec<Series> {
        let points = |name: &str| {
            let own = rows.iter().filter(|row| row.strategy == name);
            let point = |row: &Forecast| Some(Estimated::from(value(row)?).above(row.workers as f64));
            own.filter_map(point).collect::<Vec<Point>>()
        };
        Series::by_name(shown.iter().map(|name| (name, points(name)))).into_iter().map(Series::banded).collect()
    };
    let most = rows.iter().map(|row| row.workers).max().unwrap_or(1);
    // A tick at every number of cores would leave no room for the labels of some powers of two.
    let doubled = std::iter::successors(Some(1), |cores| Some(2 * cores)).take_while(|cores| *cores <= most);
    let ticks: Vec<f64> = doubled.chain([most]).map(|cores| cores as f64).collect();
    let axis = || Axis::log("cores").ticks_at(ticks.clone());
    let [best, useful, limit] = results(rows);
    let title = |description: &str, result| Title::new(description).with_result(result);
    let speedups = series(|row| Some(row.speedup));
    let mut speedup = LineChart::new(title("Forecast: speedup", best), axis(), Axis::log("speedup"), speedups);
    speedup.overlays = vec![Overlay::guide("one per core", Curve::Line { intercept: 0.0, slope: 1.0 })];
    if let Some(bound) = bound {
        speedup.overlays.push(Overlay::guide("work / longest job", Curve::Line { intercept: bound, slope: 0.0 }));
    }
    let efficiency_axis = Axis::linear("speedup per core").including([0.0, 1.0]);
    let efficiencies = series(Forecast::efficiency);
    let mut efficiency = LineChart::new(title("Forecast: efficiency", useful), axis(), efficiency_axis, efficiencies);
    efficiency.overlays = vec![Overlay::guide("ideal: 1", Curve::Line { intercept: 1.0, slope: 0.0 })];
    let mut makespans = series(|row| Some(row.makespan_s));
    makespans.extend(bounds(rows, makespans.len(), equal_cores));
    let title = title("Forecast: makespan and its bounds", limit);
    let makespan = LineChart::new(title, axis(), Axis::log("seconds"), makespans);
    let band =
        rows.iter().map(|row| (row.traces, row.calibrations)).max().map_or_else(String::new, |(t, c)| band(t, c));
    let charts = [("forecast-speedup", speedup), ("forecast-efficiency", efficiency), ("forecast-makespan", makespan)];
    for (stem, mut chart) in charts {
        chart.subtitle = workload.to_string();
        chart.caption = format!("Simulated from the jobs of serial runs. {band}{left_out}");
        blocks.push(Block::figure(stem, chart));
    }
    blocks.push(
        Block::table("forecast", "Forecast", rows)
            .column("strategy", |row| row.strategy.clone())
            .column("cores", |row| row.workers.to_string())
            .number("makespan, s", Decimals(5), |row| row.makespan_s.value)
            .estimated("speedup", Decimals(2), |row| Estimated::from(row.speedup))
            .number("efficiency", Decimals(3), |row| row.efficiency().map(|told| told.value))
            .number("serial fraction (Karp and Flatt)", Decimals(4), |row| {
                serial_fraction(row.speedup.value, row.workers)
            })
            .number("work / cores, s", Decimals(5), |row| row.share_s)
            .number("longest job, s", Decimals(5), |row| row.longest_s)
            .number("Graham's bound, s", Decimals(5), |row| row.greedy_s)
            .end(),
    );
    blocks
}

/// The strategy with the highest speedup on so many cores. The longest job first is none: it needs all costs beforehand.
pub(super) fn best(rows: &[Forecast], cores: usize) -> Option<&Forecast> {
    let own = strategies(rows).filter(|row| row.workers == cores);
    own.max_by(|a, b| a.speedup.value.total_cmp(&b.speedup.value))
}

fn strategies(rows: &[Forecast]) -> impl Iterator<Item = &Forecast> {
    rows.iter().filter(|row| row.strategy != LONGEST_FIRST)
}

/// The results in a line each: the highest speedup, the cores that are of use, and the limit of the time.
fn results(rows: &[Forecast]) -> [Option<String>; 3] {
    let most = rows.iter().map(|row| row.workers).max().filter(|most| *most > 1);
    let best = most.and_then(|most| {
        let best = best(rows, most)?;
        let speedup = titles::told(best.speedup)?;
        Some(format!(
            "On {most} cores the best schedule, {}, would be {speedup} times as fast as serial",
            best.strategy
        ))
    });
    let keeps_half = |row: &&Forecast| {
        let interval = row.efficiency().and_then(|efficiency| efficiency.interval);
        row.workers > 1 && interval.is_some_and(|interval| interval.low >= 0.5)
    };
    let useful = strategies(rows).filter(keeps_half).map(|row| row.workers).max();
    let useful =
        useful.map(|cores| format!("Up to {cores} cores, the best schedule turns half of them or more into speedup"));
    let limited = rows.iter().filter(|row| row.longest_s >= row.share_s).map(|row| row.workers).min();
    let limit = most.map(|most| match limited {
        Some(cores) => {
            format!("From {cores} cores on, the longest job takes as long as an equal share of the work or longer")
        }
        None => format!("Up to {most} cores, an equal share of the work takes longer than any job"),
    });
    [best, useful, limit]
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
        |name: &str| rows.iter().filter(|row| row.strategy == name).map(|row| row.speedup.value).collect::<Vec<f64>>();
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Work of 8 s whose longest job takes 2 s, so that four cores reach it; eight cores are half as fast as eight.
    #[test]
    fn results_tell_the_gain_the_useful_cores_and_the_limit() {
        let row = |strategy: &str, (workers, speedup): (usize, f64)| {
            let interval = Interval { low: 0.99 * speedup, high: 1.01 * speedup, level: LEVEL };
            let crossed = |value: f64, interval| Crossed { value, interval };
            Forecast {
                strategy: strategy.to_string(),
                workers,
                traces: 3,
                calibrations: 1,
                makespan_s: crossed(8.0 / speedup, None),
                speedup: crossed(speedup, Some(interval)),
                share_s: 8.0 / workers as f64,
                longest_s: 2.0,
                greedy_s: 0.0,
            }
        };
        let speedups = [(1, 1.0), (2, 2.0), (4, 3.5), (8, 4.0)];
        let mut rows: Vec<Forecast> = speedups.into_iter().map(|own| row("dynamic", own)).collect();
        // A yardstick that knows all costs is no schedule that anyone can run.
        rows.push(row(LONGEST_FIRST, (8, 7.5)));
        let told = results(&rows).map(Option::unwrap);
        assert_eq!(told[0], "On 8 cores the best schedule, dynamic, would be 4 times as fast as serial");
        assert_eq!(told[1], "Up to 4 cores, the best schedule turns half of them or more into speedup");
        assert_eq!(told[2], "From 4 cores on, the longest job takes as long as an equal share of the work or longer");
        let [best, useful, limit] = results(&rows[..1]);
        assert_eq!((best, useful, limit), (None, None, None));
    }
}
