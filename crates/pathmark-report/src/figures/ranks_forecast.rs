//! Simulated runs of several processes with the jobs measured here, and the errors of the predictions for this machine.

use crate::cluster::MessageCosts;
use crate::experiment::{MESSAGES, read_calibration};
use crate::prelude::*;
use crate::rank_forecasts::{
    self, RankPlan, rank_forecast, rank_forecast_blocks, rank_prediction_blocks, rank_predictions,
};
use crate::simulate::{Hardware, contenders};
use std::num::NonZeroUsize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Options {
    /// Rules between processes.
    rules: Vec<String>,
    /// The strategy within a process that has several threads.
    strategy: String,
    /// Numbers of processes.
    ranks: Vec<NonZeroUsize>,
    /// Numbers of threads of a process.
    threads: Vec<NonZeroUsize>,
}

impl Default for Options {
    fn default() -> Self {
        let numbers = |numbers: &[usize]| numbers.iter().copied().filter_map(NonZeroUsize::new).collect();
        Self {
            rules: ["static-cyclic", "guided", "dynamic:1"].map(str::to_string).to_vec(),
            strategy: "work-stealing".to_string(),
            ranks: numbers(&[2, 4, 8, 16, 32, 64]),
            threads: numbers(&[1, 4, 16, 64]),
        }
    }
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Options { rules, strategy, ranks, threads } = options(results, "ranks-forecast")?;
    let [calibration, messages] = ["calibration.csv", MESSAGES].map(|name| results.folder.join(name));
    if !calibration.is_file() || !messages.is_file() {
        let text = format!("There is no calibration.csv or no {MESSAGES}, so no processes can be simulated.");
        return Ok(vec![Block::notice(text)]);
    }
    let lab = &results.definition.lab;
    let contenders = contenders(lab, &read_calibration(&calibration)?);
    let messages = rank_forecasts::messages(&MessageCosts::read(&messages)?);
    let mut blocks = rank_prediction_blocks(&rank_predictions(results, &contenders, messages)?);
    if let Some(trace) = results.largest_serial_trace()? {
        let rules = rules.iter().map(|rule| lab.rank_rule("rules", rule)).collect::<Result<Vec<_>>>()?;
        let numbers = |numbers: Vec<NonZeroUsize>| numbers.into_iter().map(NonZeroUsize::get).collect::<Vec<_>>();
        let (ranks, threads) = (numbers(ranks), numbers(threads));
        let hardware = Hardware::default();
        let strategies = &[strategy][..];
        let plan = RankPlan { rules: &rules, strategies, ranks: &ranks, threads: &threads, messages, hardware };
        let costs = trace.costs_s();
        let settings = &trace.header.settings;
        let (spec, pieces) = (&settings.spec, &settings.decomposition);
        let pixels = f64::from(spec.width) * f64::from(spec.height);
        let rows = rank_forecast(&plan, &contenders, &costs, pixels);
        let of = format!("{}x{}, {} spp, {} {pieces}", spec.width, spec.height, settings.spp, costs.len());
        blocks.extend(rank_forecast_blocks(&rows, &format!("{}, {of}", settings.scene), strategies));
    }
    Ok(blocks)
}
