//! More threads than processors: by cutting the image into more sections with a thread each, and by raising the threads alone.

use crate::error::Result;
use crate::measure::Record;
use crate::plot::style::Look;
use crate::plot::{Axis, LineChart, Point, Series};
use crate::report::block::Block;
use crate::report::results::{Results, Schedule, confidence, median_with_interval, with_level};
use std::collections::BTreeMap;

/// Report D's strategy, and the one that it is compared with.
const PER_SECTION: &str = "thread-per-job";
const FEW: &str = "shared-counter";

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
            let name = if schedule.strategy == PER_SECTION {
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

/// Report D's "around 16 to 49 is a good number", against 4 sections, and against the same pieces with a thread for each processor.
fn finding(results: &Results) -> Option<Block> {
    let time = |strategy: &str, decomposition: &str, repetition: u32| {
        let same = |record: &&Record| {
            record.strategy == strategy && record.decomposition == decomposition && record.repetition == repetition
        };
        results.records.iter().find(same)?.makespan_s
    };
    let (mut against_four, mut against_few) = (Vec::new(), Vec::new());
    let in_range = |record: &&Record| {
        record.strategy == PER_SECTION && record.decomposition.starts_with("grid:") && (16..=49).contains(&record.jobs)
    };
    for record in results.records.iter().filter(in_range) {
        let Some(own_s) = record.makespan_s else { continue };
        against_four.extend(time(PER_SECTION, "grid:4", record.repetition).map(|four_s| own_s / four_s));
        against_few.extend(time(FEW, &record.decomposition, record.repetition).map(|few_s| own_s / few_s));
    }
    let in_words = |ratios: &[f64]| {
        let (value, interval) = median_with_interval(ratios)?;
        let interval = interval?;
        let verdict = match (interval.low > 1.0, interval.high < 1.0) {
            (true, _) => "longer",
            (_, true) => "shorter",
            _ => "not told apart",
        };
        Some(format!("{value:.2} times as long, {} ({verdict})", with_level(&interval, 2)))
    };
    Some(Block::Finding(format!(
        "A thread for each of 16 to 49 sections takes, against one for each of 4 sections, {}; against a thread for each of the {} processors on the same 16 to 49 sections, {}. \
         The first is what report D saw; the second is what its threads, apart from the smaller pieces, gain or cost.",
        in_words(&against_four)?,
        results.run.machine.processors,
        in_words(&against_few)?,
    )))
}
