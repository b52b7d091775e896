//! Simulated runs of several processes with the jobs measured here, and the errors of the predictions for this machine.

use crate::cluster::MessageCosts;
use crate::experiment::{MESSAGES, read_calibration};
use crate::measure::TraceFile;
use crate::prelude::*;
use crate::rank_forecasts::{
    self, RankPlan, rank_forecast, rank_forecast_blocks, rank_prediction_blocks, rank_predictions,
};
use crate::simulate::{Hardware, contenders};
use std::num::NonZeroUsize;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Options {
    /// Rules between processes.
    rules: Option<Vec<String>>,
    /// The strategy within a process that has several threads.
    strategy: Option<String>,
    /// Numbers of processes.
    ranks: Option<Vec<NonZeroUsize>>,
    /// Numbers of threads of a process.
    threads: Option<Vec<NonZeroUsize>>,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Options { rules, strategy, ranks, threads } = options(&results.definition, "ranks-forecast")?;
    let rules = rules.unwrap_or_else(|| ["static-cyclic", "guided", "dynamic:1"].map(str::to_string).to_vec());
    let strategy = strategy.unwrap_or_else(|| "work-stealing".to_string());
    let numbers = |own: Option<Vec<NonZeroUsize>>, usual: &[usize]| {
        own.map_or_else(|| usual.to_vec(), |own| own.into_iter().map(NonZeroUsize::get).collect())
    };
    let (ranks, threads) = (numbers(ranks, &[2, 4, 8, 16, 32, 64]), numbers(threads, &[1, 4, 16, 64]));
    let [calibration, messages] = ["calibration.csv", MESSAGES].map(|name| results.folder.join(name));
    if !calibration.is_file() || !messages.is_file() {
        let text = format!("There is no calibration.csv or no {MESSAGES}, so no processes can be simulated.");
        return Ok(vec![Block::notice(text)]);
    }
    let lab = &results.definition.lab;
    let contenders = contenders(lab, &read_calibration(&calibration)?);
    let messages = rank_forecasts::messages(&MessageCosts::read(&messages)?);
    let mut blocks = rank_prediction_blocks(&rank_predictions(results, &contenders, messages)?);
    let traces = results.largest_serial_traces()?;
    if let Some(trace) = traces.first() {
        let rules = rules.iter().map(|rule| lab.rank_rule("rules", rule)).collect::<Result<Vec<_>>>()?;
        let hardware = Hardware::default();
        let strategies = &[strategy][..];
        let plan = RankPlan { rules: &rules, strategies, ranks: &ranks, threads: &threads, messages, hardware };
        let costs: Vec<Vec<f64>> = traces.iter().map(TraceFile::costs_s).collect();
        let settings = &trace.header.settings;
        let (spec, pieces) = (&settings.spec, &settings.decomposition);
        let pixels = f64::from(spec.width) * f64::from(spec.height);
        let rows = rank_forecast(&plan, &contenders, &costs, pixels);
        let of = format!("{}x{}, {} spp, {} {pieces}", spec.width, spec.height, settings.spp, costs[0].len());
        blocks.extend(rank_forecast_blocks(&rows, &format!("{}, {of}, simulated", settings.scene), strategies));
    }
    Ok(blocks)
}
