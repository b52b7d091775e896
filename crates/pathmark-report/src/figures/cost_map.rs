//! The cost of each tile, over the image: the unequal pieces that schedules have to distribute.

use crate::measure::TraceRow;
use crate::plot::{HeatMap, Tile};
use crate::prelude::*;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let serial = results.by(|row| &row.schedule).into_iter().filter(|(schedule, _)| schedule.is_serial());
    // Of several decompositions, the one with the most runs of one image.
    let typical = serial.rev().filter_map(|(_, rows)| Results::typical(&rows).map(|row| (rows.len(), row)));
    let Some((_, record)) = typical.max_by_key(|(runs, _)| *runs) else { return Ok(Vec::new()) };
    let same = results.rows().filter(|row| row.schedule == record.schedule && row.image == record.image);
    let traces = results.traces_like_typical(&same.collect::<Vec<&Row>>())?;
    let Some(trace) = traces.first() else { return Ok(Vec::new()) };
    // A disturbance only lengthens a job, and it hits the neighbouring jobs of one run.
    let least_s = |index: usize| {
        let own = traces.iter().filter_map(|trace| trace.rows.get(index));
        own.map(|row| row.stop_s - row.start_s).fold(f64::INFINITY, f64::min)
    };
    let tile = |(index, row): (usize, &TraceRow)| Tile {
        x0: row.x0,
        y0: row.y0,
        x1: row.x1,
        y1: row.y1,
        value: least_s(index) * 1e3,
    };
    let tiles: Vec<Tile> = trace.rows.iter().enumerate().map(tile).collect();
    let costs = tiles.iter().map(|tile| tile.value);
    let (least, most) = (costs.clone().fold(f64::INFINITY, f64::min), costs.fold(0.0, f64::max));
    // A single run may have been disturbed.
    let result = (traces.len() > 1)
        .then(|| format!("The most expensive tile takes {:.1} times as long as the cheapest", most / least));
    let name = joined([results.series_name(record), format!("{}, {} spp", record.decomposition, record.spp)]);
    let map = HeatMap {
        title: Title::new("What a tile costs").with_result(result),
        subtitle: results.workload(),
        caption: format!("Of each tile the least time of {}.", counted(traces.len(), "serial run")),
        label: "milliseconds per tile".to_string(),
        name,
        width: record.width,
        height: record.height,
        tiles,
    };
    let finding = format!(
        "The most expensive tile takes {most:.2} ms, {:.1} times as long as the cheapest ({least:.2} ms).",
        most / least
    );
    Ok(vec![Block::figure("cost-map", map), Block::finding(finding)])
}
