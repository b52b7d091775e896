//! Tests of whole schedules, maps and dot plots: nothing is clipped, overlaps or is lost silently.

use super::drawing::Mark;
use super::tests::{assert_legible, says};
use super::{Axis, Dot, DotPlot, DotRow, Drawing, Figure, GanttChart, HeatMap, JobBar, Schedule, Tile, paint};

/// Equal jobs, one after the other, assigned to the workers in turn.
fn schedule(workers: usize, jobs: usize) -> Schedule {
    let rounds = jobs.div_ceil(workers.max(1)).max(1) as f64;
    let job = |i: usize| {
        let start_s = (i / workers) as f64 / rounds;
        JobBar {
            job: i,
            worker: i % workers,
            start_s,
            stop_s: start_s + 0.9 / rounds,
            value: (i % 7) as f64,
            area: [0, 0, 8, 8],
        }
    };
    let title = format!("strategy, {workers} threads: 1.05 s, utilisation 86 %");
    Schedule { title, workers, makespan_s: 1.05, size: [8, 8], jobs: (0..jobs).map(job).collect() }
}

fn gantt(schedules: Vec<Schedule>) -> GanttChart {
    GanttChart {
        title: "Who did what when".into(),
        subtitle: "cornell; ".repeat(20),
        caption: "A caption of some length. ".repeat(8),
        label: "cost of a job, ms".into(),
        schedules,
    }
}

fn tile(i: u32, value: f64) -> Tile {
    Tile { x0: 16 * (i % 8), y0: 16 * (i / 8), x1: 16 * (i % 8 + 1), y1: 16 * (i / 8 + 1), value }
}

fn map(value: impl Fn(u32) -> f64) -> HeatMap {
    HeatMap {
        title: "Cost of the tiles".into(),
        subtitle: "cornell".into(),
        caption: "A caption. ".repeat(20),
        label: "ms a tile".into(),
        name: "a title that is long enough to be broken over several lines. ".repeat(4),
        width: 128,
        height: 96,
        tiles: (0..48).map(|i| tile(i, value(i))).collect(),
    }
}

fn dots(rows: usize, groups: usize, axis: Axis) -> DotPlot {
    let dot =
        |i: usize| Some(Dot::new(1e-7 * (i + 1) as f64, Some((0.8e-7 * (i + 1) as f64, 1.3e-7 * (i + 1) as f64))));
    let rows = (0..rows)
        .map(|i| DotRow { name: format!("strategy-number-{i}"), dots: (0..groups).map(|g| dot(i + g)).collect() });
    let mut plot = DotPlot::new("Overhead of a job", axis, rows.collect());
    plot.groups = (0..groups).map(|g| format!("{} threads", g + 1)).collect();
    plot.guides = vec![(2e-7, "what a thread costs to wake, as measured".into())];
    plot.subtitle = "empty jobs; ".repeat(20);
    plot
}

/// Filled rectangles.
fn rectangles(drawing: &Drawing) -> usize {
    drawing.marks.iter().filter(|mark| matches!(mark, Mark::Rectangle { .. })).count()
}

#[test]
fn every_job_has_its_box_while_there_is_room() {
    let chart = gantt(vec![schedule(2, 20), schedule(4, 21)]);
    let drawing = chart.drawing();
    assert_legible(&drawing);
    // A box and an edge for each job, a background for each schedule, and the 128 steps of the colour bar.
    assert_eq!(rectangles(&drawing), 2 * (20 + 21) + 2 + 128);
    assert!(says(&drawing, "time from start, s") && says(&drawing, "a quarter of the jobs between labels"));
    assert_eq!(chart.svg().unwrap(), gantt(vec![schedule(2, 20), schedule(4, 21)]).svg().unwrap());
}

#[test]
fn many_lanes_and_many_jobs_stay_within_bounds() {
    for (workers, jobs) in [(1, 1), (3, 9), (24, 240), (96, 96), (768, 768), (2, 50_000)] {
        let drawing = gantt(vec![schedule(workers, jobs); 2]).drawing();
        assert_legible(&drawing);
        assert!(drawing.height < 2.0 * 300.0 + 260.0, "{workers}: {}", drawing.height);
        assert!(drawing.marks.len() < 12_000, "{}", drawing.marks.len());
    }
    assert!(says(&gantt(vec![schedule(768, 768)]).drawing(), "every 9th of 768 workers is shown"));
    assert!(!says(&gantt(vec![schedule(24, 24)]).drawing(), "is shown"));
}

#[test]
fn hard_schedules_give_charts() {
    let mut odd = schedule(2, 4);
    odd.jobs[0].stop_s = f64::NAN;
    odd.jobs[1].worker = 7;
    odd.jobs[2].value = f64::INFINITY;
    let drawing = gantt(vec![odd]).drawing();
    assert!(says(&drawing, "left out, as they can't be: 3 of the jobs"));
    let ends = |makespan_s| Schedule { makespan_s, ..schedule(2, 4) };
    let short = |makespan_s: f64| Schedule { jobs: Vec::new(), ..ends(makespan_s) };
    for schedules in [
        vec![],
        vec![ends(f64::NAN)],
        vec![short(1e-9)],
        vec![short(3e-4), short(2e-2)],
        vec![ends(0.5)],
        vec![Schedule { workers: 0, jobs: vec![], ..ends(1.0) }],
    ] {
        let chart = gantt(schedules);
        assert_legible(&chart.drawing());
        assert!(!chart.svg().unwrap().contains("NaN"));
        paint::pixels(&chart.drawing(), 1.0).unwrap();
    }
    assert!(says(&gantt(vec![]).drawing(), "no data"));
    assert!(says(&gantt(vec![short(2e-2)]).drawing(), "time from start, ms"));
}

#[test]
fn maps_show_every_tile_and_the_scale() {
    let drawing = map(f64::from).drawing();
    assert_legible(&drawing);
    assert_eq!(rectangles(&drawing), 48 + 128);
    assert!(says(&drawing, "47") && says(&drawing, "ms a tile"));
    let wide = HeatMap { width: 4000, ..map(|_| 3.0) };
    assert_eq!(wide.drawing().texts().filter(|text| text.text == "3").count(), 5);
    assert_legible(&wide.drawing());
}

#[test]
fn tiles_without_a_value_are_counted() {
    assert!(says(&map(|i| if i < 2 { f64::NAN } else { 1.0 }).drawing(), "2 rectangles have no value"));
    let empty = map(|_| f64::NAN);
    assert!(says(&empty.drawing(), "no data"));
    assert_legible(&empty.drawing());
    assert!(!empty.svg().unwrap().contains("NaN"));
    assert!(says(&HeatMap { tiles: Vec::new(), ..map(f64::from) }.drawing(), "no data"));
}

#[test]
fn rows_and_groups_are_all_there() {
    for (rows, groups) in [(1, 1), (24, 1), (24, 3), (3, 8)] {
        for axis in [Axis::linear("s a job").including([0.0]), Axis::log("s a job")] {
            let plot = dots(rows, groups, axis);
            let drawing = plot.drawing();
            assert_legible(&drawing);
            assert!((0..rows).all(|i| says(&drawing, &format!("strategy-number-{i}"))));
            assert_eq!(says(&drawing, "1 threads"), groups > 1);
            let caps = drawing.marks.iter().filter(|mark| matches!(mark, Mark::Disc { .. }));
            assert!(caps.count() >= 2 * rows);
        }
    }
}

/// Each group has a range of its own, so its largest dot is as far right as in every other area.
#[test]
fn groups_side_by_side_do_not_share_an_axis() {
    for axis in [Axis::linear("s a job"), Axis::log("s a job")] {
        let mut plot = dots(24, 3, axis);
        plot.side_by_side = true;
        for row in &mut plot.rows {
            let larger = |dot: &Dot| {
                let interval = dot.interval.map(|(low, high)| (8.0 * low, 8.0 * high));
                Dot { value: 8.0 * dot.value, interval, ..*dot }
            };
            row.dots[1] = row.dots[0].as_ref().map(larger);
        }
        let drawing = plot.drawing();
        assert_legible(&drawing);
        let ends = |group: &str| {
            let own = drawing.notes.iter().filter(|note| note.series == group).map(|note| note.at.0);
            own.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)))
        };
        let [first, second, third] = ["1 threads", "2 threads", "3 threads"].map(ends);
        assert!(first.1 < second.0 && second.1 < third.0, "{first:?} {second:?} {third:?}");
        let width = |(low, high): (f64, f64)| high - low;
        assert!((width(first) - width(second)).abs() < 1e-6, "{first:?} {second:?}");
        assert!(says(&drawing, "1 threads") && says(&drawing, "3 threads"));
    }
}

#[test]
fn dots_without_a_place_are_counted() {
    let mut plot = dots(3, 1, Axis::log("s"));
    plot.rows[0].dots[0] = Some(Dot::new(0.0, None));
    plot.rows[1].dots[0] = Some(Dot::new(1e-7, Some((-1.0, f64::INFINITY))));
    plot.rows[2].dots[0] = None;
    assert!(says(&plot.drawing(), "1 dot has no place"));
    assert_legible(&plot.drawing());
    plot.rows.truncate(1);
    assert!(says(&plot.drawing(), "no data"));
    assert!(!plot.svg().unwrap().contains("NaN"));
    assert_legible(&DotPlot::new("t", Axis::linear("x"), vec![]).drawing());
}
