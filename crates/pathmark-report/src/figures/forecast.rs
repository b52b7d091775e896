//! Simulated schedules of the jobs measured here on other machines, and the errors of the predictions for this machine.

use crate::experiment::read_calibration;
use crate::forecasts::{band, best, forecast_blocks, prediction_blocks, predictions};
use crate::measure::{THREAD_PER_ROW, TraceFile};
use crate::plot::number::{between, short};
use crate::prelude::*;
use crate::simulate::{Contender, Forecast, Hardware, LONGEST_FIRST, contenders, forecast, typical_costs};
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
    let path = results.calibration_path();
    if !path.is_file() {
        return Ok(vec![Block::notice("There is no calibration.csv, so nothing can be simulated.")]);
    }
    let mut contenders = contenders(&results.definition.lab, &read_calibration(&path)?);
    let mut blocks = prediction_blocks(&predictions(results, &contenders)?);
    let serial = results.rows().filter(|row| row.schedule.is_serial() && row.decomposition == decomposition);
    let traces = results.traces_like_typical(&serial.collect::<Vec<&Row>>())?;
    if let Some(trace) = traces.first() {
        let costs: Vec<Vec<f64>> = traces.iter().map(TraceFile::costs_s).collect();
        contenders.push(Contender::longest_first());
        let rows = forecast(&costs, &contenders, &cores, &Hardware::default(), LEVEL);
        let (settings, jobs) = (&trace.header.settings, costs[0].len());
        let (spec, spp) = (&settings.spec, settings.spp);
        let of = format!("{}x{}, {spp} spp, {jobs} {decomposition}", spec.width, spec.height);
        if decomposition == "rows" {
            blocks.extend(claim(&rows, &typical_costs(&costs)).into_iter().flatten());
        }
        blocks.extend(forecast_blocks(&rows, &format!("{}, {of}, simulated", settings.scene), true, &[]));
    }
    Ok(blocks)
}

/// Upper over lower end of an interval with which a forecast counts as known.
const NARROW: f64 = 1.25;

/// A finding about report A's "1/h times faster".
fn claim(rows: &[Forecast], costs: &[f64]) -> Option<[Block; 2]> {
    let largest = rows.iter().map(|row| row.workers).max()?;
    let at = |cores: usize| rows.iter().find(|row| row.strategy == "thread-per-job" && row.workers == cores);
    let (two, sixteen, all) = (at(2)?, at(16)?, at(largest)?);
    let best = best(rows, largest)?;
    let yardstick = rows.iter().find(|row| row.strategy == LONGEST_FIRST && row.workers == largest);
    let mean = costs.iter().sum::<f64>() / costs.len() as f64;
    let told = |row: &Forecast| short(row.speedup.value, 3) + &between(Estimated::from(row.speedup).bar(), 3);
    let yardstick = yardstick.map_or_else(String::new, |row| {
        format!(" The yardstick {LONGEST_FIRST}, which knows all costs beforehand, reaches {}.", told(row))
    });
    let text = format!(
        "On {largest} cores a thread for each row would be {} times as fast as serial, and the best schedule, {}, {} times. Simulated.",
        told(all),
        best.strategy,
        told(best),
    );
    let is_narrow = |row: &Forecast| Estimated::from(row.speedup).bar().is_some_and(|(low, high)| high <= NARROW * low);
    let answer = Block::Answer { text, stem: "forecast-speedup", is_told: is_narrow(all) && is_narrow(best) };
    let finding = Block::finding(format!(
        "Simulated, with intervals of {:.0} % confidence: {THREAD_PER_ROW} (a thread for each of {} rows) would be {} times as fast as serial on 2 cores, {} times on 16 and {} times on {largest}, not {largest}: the longest row takes {:.2} times the mean ({:.2} times the \
         median), which alone allows no more than {:.0}, and threads are started one after the other. The best schedule on {largest} cores, {}, reaches {}.{yardstick} {}",
        100.0 * LEVEL,
        costs.len(),
        told(two),
        told(sixteen),
        told(all),
        all.longest_s / mean,
        all.longest_s / median(costs)?,
        costs.iter().sum::<f64>() / all.longest_s,
        best.strategy,
        told(best),
        band(all.traces, all.calibrations),
    ));
    Some([answer, finding])
}
