//! Laws of speedup fitted to what was measured; where the points can't tell, the table says why.

use crate::analysis::scaling_law::{Fit, Law, Parameter, Point, fit};
use crate::error::Result;
use crate::report::block::{Block, Table};
use crate::report::results::{LEVEL, Results, Schedule, with_level};
use std::collections::BTreeMap;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    Ok(vec![table(results, &[Law::Amdahl, Law::Universal], "scaling-laws")])
}

/// The fits of each law to each strategy, over worker counts that have a processor each: beyond that, more workers are no more machine.
pub(super) fn table(results: &Results, laws: &[Law], stem: &'static str) -> Block {
    let processors = results.run.machine.processors;
    let points = points(results);
    let rows = points.iter().flat_map(|(strategy, points)| laws.iter().map(move |law| row(strategy, *law, points)));
    let columns = ["strategy", "law", "parameters, interval (confidence)", "does it describe the points?"];
    let title = format!("Laws of speedup, up to {processors} threads on {processors} processors");
    Block::Table { stem, table: Table { title, columns: columns.map(String::from).to_vec(), rows: rows.collect() } }
}

/// The speedups of each strategy at worker counts that have a processor each.
pub(super) fn points(results: &Results) -> BTreeMap<String, Vec<Point>> {
    let mut points: BTreeMap<String, Vec<Point>> = BTreeMap::new();
    for schedule in results.by(Schedule::of).into_keys() {
        if schedule.strategy != "serial" && schedule.threads <= results.run.machine.processors {
            let speedups = results.paired_speedups(&schedule);
            points.entry(schedule.strategy).or_default().push((schedule.threads, speedups));
        }
    }
    points
}

fn row(strategy: &str, law: Law, points: &[Point]) -> Vec<String> {
    let (parameters, verdict) = match fit(law, points, LEVEL) {
        Fit::Unidentifiable(reason) => ("none".to_string(), format!("not identifiable: {reason}")),
        Fit::Found(fitted) => {
            let parameter = |parameter: &Parameter| {
                let estimate = &parameter.estimate;
                format!("{} = {:.4}, {}", parameter.name, estimate.value, with_level(&estimate.interval, 4))
            };
            let mut parameters: Vec<String> = fitted.parameters.iter().map(parameter).collect();
            if let Some(peak) = &fitted.peak {
                parameters.push(format!("peak at p = {:.0}, {}", peak.value, with_level(&peak.interval, 0)));
            }
            let counts = fitted.worker_counts;
            (parameters.join("; "), format!("{}; {counts} thread counts above 1", fitted.check))
        }
    };
    vec![strategy.to_string(), law.to_string(), parameters, verdict]
}
