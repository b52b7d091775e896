//! What other machines would make of the jobs that were measured here, and how well this machine is predicted.

use crate::analysis::quantile::median;
use crate::error::Result;
use crate::experiment::read_calibration;
use crate::measure::{Record, THREAD_PER_ROW};
use crate::report::block::Block;
use crate::report::forecasts::{forecast_blocks, prediction_blocks, predictions};
use crate::report::results::Results;
use crate::simulate::{Contender, Forecast, Hardware, contenders, forecast};

/// Cores of the machines that are looked at.
const CORES: [usize; 12] = [1, 2, 4, 8, 16, 32, 64, 128, 256, 384, 512, 768];

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let path = results.folder.join("calibration.csv");
    if !path.is_file() {
        return Ok(vec![Block::Finding("There is no calibration.csv, so nothing can be simulated.".to_string())]);
    }
    let contenders = contenders(&results.definition.lab, &read_calibration(&path)?);
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
        blocks.extend(forecast_blocks(&rows, &format!("{}, {of}, simulated", record.scene), true));
    }
    Ok(blocks)
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
