//! Simulated and predicted runs of several processes as tables and a chart: for an experiment's figure and for
//! `simulate --ranks`.

use super::forecasts::{all_runs, band, in_words, serial_costs};
use crate::analysis::crossed::{Crossed, geometric_mean};
use crate::cluster::MessageCosts;
use crate::lab::{LOOK, Lab, RankRule};
use crate::plot::number::{between, short};
use crate::prelude::*;
use crate::simulate::{Cluster, Contender, Crew, Hardware, Messages, relative_errors};

/// Bytes sent to rank 0 for a pixel: three sums, three sums of squares, and the number of samples.
const PIXEL_BYTES: f64 = 56.0;

pub fn messages(costs: &MessageCosts) -> Messages {
    let needs_rank_0 = (costs.fetch_while_rendering_s() - costs.fetch_s()) / LOOK.as_secs_f64();
    Messages {
        request_s: costs.request_s(),
        fetch_s: costs.fetch_s(),
        needs_rank_0: needs_rank_0.clamp(0.0, 1.0),
        gathered_byte_s: costs.gathered_byte_s(),
    }
}

/// The prediction for all runs of a rule on the same numbers of ranks and threads.
pub struct RankPrediction {
    rule: String,
    strategy: String,
    pieces: String,
    crew: Crew,
    runs: usize,
    predicted_s: f64,
    measured_s: f64,
    ratio: f64,
}

pub struct RankForecast {
    rule: String,
    strategy: String,
    crew: Crew,
    /// Numbers of serial runs and calibrations behind the values.
    sources: (usize, usize),
    makespan_s: Crossed,
    speedup: Crossed,
    gather_s: f64,
}

/// The schedule within a rank: `strategy`, or `serial` if the rank has one thread. `None` if no contender has that
/// name.
fn within<'a>(contenders: &'a [Contender], strategy: &str, threads: usize) -> Option<&'a Contender> {
    let name = if threads == 1 { crate::measure::SERIAL } else { strategy };
    contenders.iter().find(|contender| contender.name == name)
}

/// Predicts the runs of several processes from the serial run of the same pieces in the same repetition. Leaves out
/// runs with more threads than processors.
pub fn rank_predictions(
    results: &Results,
    contenders: &[Contender],
    messages: Messages,
) -> Result<Vec<RankPrediction>> {
    let lab: &Lab = &results.definition.lab;
    let (serial, costs, processors) = (results.serial()?, serial_costs(results)?, results.run.machine.processors);
    let pairs = serial.in_order(results);
    let pairs = pairs.iter().filter(|(row, _)| row.threads <= processors);
    let groups = gathered(pairs.filter_map(|(row, serial)| {
        let written = row.as_written();
        let crew = (written.ranks?, written.threads);
        let key = (written.rank_rule.clone(), written.strategy.clone(), written.decomposition.clone(), crew);
        Some((key, (row, serial)))
    }));
    let mut predictions = Vec::new();
    for ((rule, strategy, pieces, (ranks, threads)), pairs) in groups {
        let crew = Crew { ranks: ranks.into(), threads };
        let distribution = lab.rank_rule("rank-rule", &rule)?.distribution();
        let Some(within) = within(contenders, &strategy, threads) else { continue };
        let cluster = Cluster { crew, within, messages, hardware: Hardware::default() };
        let seconds = |(row, serial): &(&Row, &Row)| {
            let costs = costs.get(&(serial.cell.as_str(), serial.repetition))?;
            Some([cluster.makespan_s(costs, distribution), row.makespan_s?])
        };
        let pairs: Vec<[f64; 2]> = pairs.iter().filter_map(seconds).collect();
        let middle = |value: fn(&[f64; 2]) -> f64| median(&pairs.iter().map(value).collect::<Vec<f64>>());
        let medians = (middle(|pair| pair[0]), middle(|pair| pair[1]), middle(|pair| pair[0] / pair[1]));
        if let (Some(predicted_s), Some(measured_s), Some(ratio)) = medians {
            let runs = pairs.len();
            predictions.push(RankPrediction { rule, strategy, pieces, crew, runs, predicted_s, measured_s, ratio });
        }
    }
    Ok(predictions)
}

/// A finding about the errors, and a table of predicted and measured makespans.
pub fn rank_prediction_blocks(predictions: &[RankPrediction]) -> Vec<Block> {
    let pairs: Vec<(f64, f64)> = predictions.iter().map(|prediction| (prediction.ratio, 1.0)).collect();
    let Some(found) = relative_errors(&pairs) else { return Vec::new() };
    let runs = predictions.iter().map(|prediction| prediction.runs).sum();
    let finding = format!(
        "{} of processes of this machine predicted from serial runs. Over {}: {}.",
        counted(predictions.len(), "schedule"),
        all_runs(runs),
        in_words(&found),
    );
    let table = Block::table("rank-predictions", "The simulator predicts processes on this machine", predictions)
        .column("rule", |p| p.rule.clone())
        .column("strategy within", |p| p.strategy.clone())
        .column("pieces", |p| p.pieces.clone())
        .column("processes", |p| p.crew.ranks.to_string())
        .column("threads of each", |p| p.crew.threads.to_string())
        .column("runs", |p| p.runs.to_string())
        .number("predicted ms", Decimals(2), |p| p.predicted_s * 1e3)
        .number("measured ms", Decimals(2), |p| p.measured_s * 1e3)
        .number("error, %", Decimals(1), |p| 100.0 * (p.ratio - 1.0))
        .end();
    vec![Block::Finding(finding), table]
}

/// The cases of a forecast of ranks.
pub struct RankPlan<'a> {
    pub rules: &'a [RankRule],
    /// The strategies within a rank that has several threads.
    pub strategies: &'a [String],
    pub ranks: &'a [usize],
    pub threads: &'a [usize],
    pub messages: Messages,
    pub hardware: Hardware,
}

/// Replays the jobs of each trace (costs in seconds) with the costs of each calibration, by every rule on all numbers
/// of ranks and threads. `pixels` is the size of their image.
pub fn rank_forecast(
    plan: &RankPlan<'_>,
    contenders: &[Contender],
    traces: &[Vec<f64>],
    pixels: f64,
) -> Vec<RankForecast> {
    let mut rows = Vec::new();
    for rule in plan.rules {
        // A rank with one thread runs its jobs in order, whatever the strategy.
        let crews = plan.threads.iter().flat_map(|&threads| {
            let strategies = if threads == 1 { plan.strategies.get(..1).unwrap_or_default() } else { plan.strategies };
            strategies.iter().map(move |strategy| (threads, strategy))
        });
        for (threads, strategy) in crews {
            let Some(within) = within(contenders, strategy, threads) else { continue };
            let by_calibration = within.by_calibration();
            for &ranks in plan.ranks.iter().filter(|ranks| rule.check(**ranks).is_ok()) {
                let crew = Crew { ranks, threads };
                let cluster = |within| Cluster { crew, within, messages: plan.messages, hardware: plan.hardware };
                let replays = |costs: &Vec<f64>| -> Vec<f64> {
                    by_calibration.iter().map(|one| cluster(one).makespan_s(costs, rule.distribution())).collect()
                };
                let makespans: Vec<Vec<f64>> = traces.iter().map(replays).collect();
                let works = traces.iter().map(|costs| costs.iter().sum::<f64>());
                let over = |(work_s, row): (f64, &Vec<f64>)| row.iter().map(|makespan_s| work_s / makespan_s).collect();
                let speedups: Vec<Vec<f64>> = works.zip(&makespans).map(over).collect();
                let told = geometric_mean(&makespans, LEVEL).zip(geometric_mean(&speedups, LEVEL));
                let Some((makespan_s, speedup)) = told else { continue };
                let gather_s = cluster(within).gather_s(PIXEL_BYTES * pixels);
                let (rule, strategy) = (rule.to_string(), within.name.clone());
                let sources = (traces.len(), by_calibration.len());
                rows.push(RankForecast { rule, strategy, crew, sources, makespan_s, speedup, gather_s });
            }
        }
    }
    rows
}

/// The files that the blocks of [`rank_forecast_blocks`] are saved in.
pub const RANK_FORECAST_FILES: &[&str] = &["ranks-forecast.svg", "ranks-forecast.png", "ranks-forecast.csv"];

/// A chart of speedup against cores, and a table of all values. `strategies` are those of the plan.
pub fn rank_forecast_blocks(rows: &[RankForecast], workload: &str, strategies: &[String]) -> Vec<Block> {
    let name = |row: &RankForecast| match (strategies, row.crew.threads) {
        ([_, _, ..], 2..) => format!("{}, {} by {}", row.rule, counted(row.crew.threads, "thread"), row.strategy),
        (_, threads) => format!("{}, {}", row.rule, counted(threads, "thread")),
    };
    let cores = |row: &RankForecast| (row.crew.ranks * row.crew.threads) as f64;
    let rules: BTreeSet<&str> = rows.iter().map(|row| row.rule.as_str()).collect();
    let threads: BTreeSet<usize> = rows.iter().map(|row| row.crew.threads).collect();
    let look = |row: &RankForecast| {
        let colour = rules.iter().position(|rule| *rule == row.rule).unwrap_or(0);
        let within = strategies.iter().position(|strategy| *strategy == row.strategy).unwrap_or(0);
        let dash = threads.iter().position(|threads| *threads == row.crew.threads).unwrap_or(0);
        Look::of(colour + rules.len() * within, dash)
    };
    let mut series: Vec<Series> = Vec::new();
    for row in rows {
        let point = Estimated::from(row.speedup).above(cores(row));
        match series.iter_mut().find(|series| series.name == name(row)) {
            Some(series) => series.points.push(point),
            None => series.push(Series::new(name(row), look(row), vec![point]).banded()),
        }
    }
    let best = rows.iter().max_by(|a, b| a.speedup.value.total_cmp(&b.speedup.value));
    let result = best.and_then(|row| {
        let speedup = titles::told(row.speedup)?;
        Some(format!("On {} cores {} would be {speedup} times as fast as one core", cores(row), row.rule))
    });
    let mut chart = LineChart::new(
        Title::new("Simulated: speedup of processes").with_result(result),
        Axis::log("cores: processes times threads"),
        Axis::log("speedup"),
        series,
    );
    chart.overlays = vec![Overlay::guide("one per core", Curve::Line { intercept: 0.0, slope: 1.0 })];
    chart.subtitle = format!("{workload}, {} within", strategies.join(" or "));
    let band = rows.iter().map(|row| row.sources).max().map_or_else(String::new, |(t, c)| band(t, c));
    let caption =
        "Colour: rule; dashes: threads of a process. Simulated from the jobs of serial runs, without gathering.";
    chart.caption = format!("{caption} {band}");
    let finding = best.map(|row| {
        Block::finding(format!(
            "Simulated: on {} of {} each, {} would be {} times as fast as one core{}; gathering the film would take {:.3} ms more.",
            counted(row.crew.ranks, "process"),
            counted(row.crew.threads, "thread"),
            row.rule,
            short(row.speedup.value, 4),
            between(Estimated::from(row.speedup).bar(), 4),
            1e3 * row.gather_s,
        ))
    });
    let table = Block::table("ranks-forecast", "Forecast: processes", rows)
        .column("rule", |row| row.rule.clone())
        .column("processes", |row| row.crew.ranks.to_string())
        .column("threads of each", |row| row.crew.threads.to_string())
        .number("makespan, s", Decimals(5), |row| row.makespan_s.value)
        .estimated("speedup", Decimals(2), |row| Estimated::from(row.speedup))
        .number("efficiency", Decimals(3), |row| row.speedup.value / (row.crew.ranks * row.crew.threads) as f64)
        .number("gathering, ms", Significant(3), |row| 1e3 * row.gather_s)
        .column("strategy within", |row| row.strategy.clone())
        .end();
    finding.into_iter().chain([Block::figure("ranks-forecast", chart), table]).collect()
}
