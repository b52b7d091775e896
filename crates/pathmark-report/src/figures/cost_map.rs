//! The cost of each tile, over the image: the unequal pieces that schedules have to distribute.

use crate::plot::{HeatMap, Tile};
use crate::prelude::*;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let serial = results.by(|row| &row.schedule).into_iter().filter(|(schedule, _)| schedule.is_serial());
    // Of several decompositions, the one with the most runs of one image.
    let typical = serial.rev().filter_map(|(_, rows)| Results::typical(&rows).map(|row| (rows.len(), row)));
    let Some((_, record)) = typical.max_by_key(|(runs, _)| *runs) else { return Ok(Vec::new()) };
    let Some(trace) = results.trace(record)? else { return Ok(Vec::new()) };
    let tile = |row: &crate::measure::TraceRow| Tile {
        x0: row.x0,
        y0: row.y0,
        x1: row.x1,
        y1: row.y1,
        value: (row.stop_s - row.start_s) * 1e3,
    };
    let tiles: Vec<Tile> = trace.rows.iter().map(tile).collect();
    let costs = tiles.iter().map(|tile| tile.value);
    let (least, most) = (costs.clone().fold(f64::INFINITY, f64::min), costs.fold(0.0, f64::max));
    let name = joined([results.series_name(record), format!("{}, {} spp", record.decomposition, record.spp)]);
    let map = HeatMap {
        title: "What a tile costs".to_string(),
        subtitle: results.workload(),
        caption: "One serial run, the one with the median time.".to_string(),
        label: "milliseconds per tile".to_string(),
        name,
        width: record.width,
        height: record.height,
        tiles,
    };
    let finding = format!(
        "The dearest tile takes {most:.2} ms, {:.1} times as long as the cheapest ({least:.2} ms).",
        most / least
    );
    Ok(vec![Block::figure("cost-map", map), Block::finding(finding)])
}
