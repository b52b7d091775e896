//! More threads than processors: by cutting the image into more sections with a thread each, and by raising the threads alone.

use crate::error::Result;
use crate::measure::Record;
use crate::plot::style::Look;
use crate::plot::{Axis, LineChart, Point, Series};
use crate::report::block::Block;
use crate::report::results::{Results, Schedule, confidence, median_with_interval};
use std::collections::BTreeMap;

/// Points of time against something, by series.
type Lines = BTreeMap<String, Vec<Point>>;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let (mut by_grid, mut by_threads): (Lines, Lines) = (BTreeMap::new(), BTreeMap::new());
    let mut intervals = Vec::new();
    for (schedule, records) in results.by(Schedule::of) {
        let times: Vec<f64> = records.iter().filter_map(|record| record.makespan_s).collect();
        let Some((median, interval)) = median_with_interval(&times) else { continue };
        intervals.extend(interval);
        let bar = interval.map(|interval| (interval.low * 1e3, interval.high * 1e3));
        let point = |x: usize| Point::new(x as f64, median * 1e3).with_y(bar);
        let jobs = records.first().map_or(0, |record| record.jobs);
        if schedule.decomposition.starts_with("grid:") {
            let name = if schedule.threads == jobs {
                "a thread for each section"
            } else {
                "shared counter, a thread for each processor"
            };
            by_grid.entry(name.to_string()).or_default().push(point(jobs));
        } else if schedule.strategy != "serial" {
            by_threads.entry(schedule.strategy).or_default().push(point(schedule.threads));
        }
    }
    let caption = format!("Median. Bars: {}.", confidence(&intervals));
    let grid_ticks: Vec<f64> = ticks(&by_grid);
    let mut grid = LineChart::new(
        "Time against sections of the image (report D)",
        Axis::linear("sections").ticks_at(grid_ticks),
        Axis::linear("milliseconds").including([0.0]),
        series(by_grid),
    );
    let thread_ticks: Vec<f64> = ticks(&by_threads);
    let mut threads = LineChart::new(
        "Time against threads, the pieces being the same",
        Axis::log("threads").ticks_at(thread_ticks),
        Axis::linear("milliseconds").including([0.0]),
        series(by_threads),
    );
    for chart in [&mut grid, &mut threads] {
        chart.subtitle = results.workload();
        chart.caption.clone_from(&caption);
        chart.dodge = 4.0;
    }
    let mut blocks = vec![
        Block::Figure { stem: "sections", figure: Box::new(grid) },
        Block::Figure { stem: "threads", figure: Box::new(threads) },
    ];
    blocks.extend(finding(results));
    Ok(blocks)
}

fn ticks(lines: &Lines) -> Vec<f64> {
    let mut ticks: Vec<f64> = lines.values().flatten().map(|point| point.x).collect();
    ticks.sort_by(f64::total_cmp);
    ticks.dedup();
    ticks
}

fn series(lines: Lines) -> Vec<Series> {
    let sorted = |mut points: Vec<Point>| {
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        points
    };
    let lines = lines.into_iter().enumerate();
    lines.map(|(index, (name, points))| Series::new(name, Look::nth(index), sorted(points))).collect()
}

/// Report D's "around 16 to 49 is a good number" against the same pieces with a thread for each processor.
fn finding(results: &Results) -> Option<Block> {
    let grids = |per_job: bool| {
        move |record: &Record| {
            record.decomposition.starts_with("grid:")
                && (16..=49).contains(&record.jobs)
                && (record.strategy == "thread-per-job") == per_job
        }
    };
    let one_section = |record: &Record| record.decomposition == "grid:4" && record.strategy == "thread-per-job";
    let median_of = |wanted: &dyn Fn(&Record) -> bool| {
        let times: Vec<f64> =
            results.records.iter().filter(|record| wanted(record)).filter_map(|record| record.makespan_s).collect();
        crate::analysis::quantile::median(&times)
    };
    let (four, many, few) = (median_of(&one_section)?, median_of(&grids(true))?, median_of(&grids(false))?);
    Some(Block::Finding(format!(
        "A thread for each of 16 to 49 sections takes {:.2} times as long as one for each of 4 (medians), so report D's range is a good one on {} processors as well, if threads and sections \
         are tied together. But a thread for each processor on the same 16 to 49 sections takes {:.2} times as long as a thread for each section: what helps is the smaller pieces, not the threads.",
        many / four,
        results.run.machine.processors,
        few / many,
    )))
}
