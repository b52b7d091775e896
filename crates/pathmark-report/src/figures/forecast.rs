//! Simulated schedules of the jobs measured here on other machines, and the errors of the predictions for this machine.

use crate::experiment::read_calibration;
use crate::forecasts::{forecast_blocks, prediction_blocks, predictions};
use crate::measure::THREAD_PER_ROW;
use crate::prelude::*;
use crate::simulate::{Contender, Forecast, Hardware, contenders, forecast};
use std::num::NonZeroUsize;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Options {
    /// Cores of the simulated machines.
    cores: Option<Vec<NonZeroUsize>>,
    /// The pieces whose serial run gives the jobs.
    decomposition: Option<String>,
}

const CORES: [usize; 12] = [1, 2, 4, 8, 16, 32, 64, 128, 256, 384, 512, 768];

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Options { cores, decomposition } = options(&results.definition, "forecast")?;
    let cores = cores.map_or(CORES.to_vec(), |cores| cores.into_iter().map(NonZeroUsize::get).collect());
    let decomposition = decomposition.unwrap_or_else(|| "rows".to_string());
    let path = results.folder.join("calibration.csv");
    if !path.is_file() {
        return Ok(vec![Block::notice("There is no calibration.csv, so nothing can be simulated.")]);
    }
    let mut contenders = contenders(&results.definition.lab, &read_calibration(&path)?);
    let mut blocks = prediction_blocks(&predictions(results, &contenders)?);
    let serial = results.rows().filter(|row| row.schedule.is_serial() && row.decomposition == decomposition);
    if let Some(row) = Results::typical(&serial.collect::<Vec<&Row>>())
        && let Some(trace) = results.trace(row)?
    {
        let costs = trace.costs_s();
        contenders.push(Contender::longest_first());
        let rows = forecast(&costs, &contenders, &cores, &Hardware::default());
        let of = format!("{}x{}, {} spp, {} {decomposition}", row.width, row.height, row.spp, costs.len());
        if decomposition == "rows" {
            blocks.extend(claim(&rows, &costs));
        }
        blocks.extend(forecast_blocks(&rows, &format!("{}, {of}, simulated", row.scene), true, &[]));
    }
    Ok(blocks)
}

/// A finding about report A's "1/h times faster".
fn claim(rows: &[Forecast], costs: &[f64]) -> Option<Block> {
    let largest = rows.iter().map(|row| row.workers).max()?;
    let at = |cores: usize| rows.iter().find(|row| row.strategy == "thread-per-job" && row.workers == cores);
    let (two, sixteen, all) = (at(2)?, at(16)?, at(largest)?);
    let best = rows.iter().filter(|row| row.workers == largest).max_by(|a, b| a.speedup.total_cmp(&b.speedup))?;
    let mean = costs.iter().sum::<f64>() / costs.len() as f64;
    Some(Block::finding(format!(
        "{THREAD_PER_ROW} (a thread for each of {} rows) would be {:.2} times as fast as serial on 2 cores, {:.1} times on 16 and {:.0} times on {largest}, not {largest}: the longest row takes {:.2} times the mean ({:.2} times the \
         median), which alone allows no more than {:.0}, and threads are started one after the other. The best of all schedules on {largest} cores, {}, reaches {:.0}.",
        costs.len(),
        two.speedup,
        sixteen.speedup,
        all.speedup,
        all.longest_s / mean,
        all.longest_s / median(costs)?,
        costs.iter().sum::<f64>() / all.longest_s,
        best.strategy,
        best.speedup,
    )))
}
