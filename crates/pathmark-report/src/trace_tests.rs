//! Figures from traces and calibrations, on runs whose schedules follow from closed forms.

use super::block::Block;
use super::figures::blocks;
use super::results::Results;
use super::tests::{folder_of, row};
use crate::csv_file;
use crate::experiment::trace_file;
use crate::lab::Lab;
use crate::measure::{CalibrationRow, Record, Settings, TraceFile, TraceHeader, TraceRow};
use crate::plot::drawing::Note;
use tempfile::TempDir;

/// The trace of a serial run of these jobs, as `workers` workers would have it in turns.
fn trace(strategy: &str, costs: &[f64], workers: u32) -> TraceFile {
    let mut start_s = 0.0;
    let job = |(job, seconds): (usize, &f64)| {
        let (x0, stop_s) = (job as u32, start_s + seconds);
        let worker = x0 % workers;
        let (y0, x1, y1, first_sample) = (0, x0 + 1, 1, 0);
        let own =
            TraceRow { job, worker, start_s, stop_s, paths: 4, rays: 4, x0, y0, x1, y1, first_sample, samples: 4 };
        start_s = stop_s;
        own
    };
    let rows = costs.iter().enumerate().map(job).collect();
    let makespan_s = costs.iter().sum();
    let settings = Settings { strategy: strategy.to_string(), ..Settings::default() };
    let header = TraceHeader { settings, makespan_s, workers, warnings: String::new() };
    TraceFile { header, rows }
}

/// Three repetitions of serial runs of four jobs, each with a run of static blocks on two threads, in which every job
/// takes a quarter longer, and one with a thread for each job.
fn folder(figures: &[&str], more: &str) -> TempDir {
    folder_with(figures, more, [""; 3])
}

/// The same with the warnings of each repetition.
fn folder_with(figures: &[&str], more: &str, warnings: [&str; 3]) -> TempDir {
    let serial = [[1.0, 1.0, 1.0, 3.0], [1.0, 1.0, 9.0, 1.0], [1.0, 2.0, 1.0, 1.0]];
    let mut rows = Vec::new();
    for (repetition, costs) in serial.iter().enumerate() {
        let repetition = repetition as u32;
        let work_s: f64 = costs.iter().sum();
        let makespan_s = 1.25 * f64::max(costs[0] + costs[1], costs[2] + costs[3]);
        for (strategy, threads, makespan_s, busy_s) in [
            ("serial", 1, work_s, work_s),
            ("static-blocks", 2, makespan_s, 1.25 * work_s),
            ("thread-per-job", 4, 9.0, 30.0),
        ] {
            let (makespan_s, busy_sum_s, cpu_user_s) = (Some(makespan_s), Some(busy_s), Some(busy_s));
            let cell = strategy.to_string();
            let strategy = cell.clone();
            rows.push(Record {
                cell,
                repetition,
                strategy,
                threads,
                makespan_s,
                busy_sum_s,
                cpu_user_s,
                jobs: 4,
                warnings: warnings[repetition as usize].to_string(),
                ..row()
            });
        }
    }
    let out = folder_of(figures, more, rows);
    let folder = out.path().join("an-experiment");
    std::fs::create_dir(folder.join("traces")).unwrap();
    for (repetition, costs) in serial.iter().enumerate() {
        for (cell, workers) in [("serial", 1), ("static-blocks", 2), ("thread-per-job", 4)] {
            let path = folder.join("traces").join(trace_file(cell, repetition as u32));
            trace(cell, costs, workers).write(&path).unwrap();
        }
    }
    out
}

/// Calibrations in which a thread takes these seconds to start.
fn calibrate(out: &TempDir, starts: &[f64]) {
    let of_one = |(calibration, start_s): (usize, f64)| {
        ["static-blocks", "thread-per-job"].into_iter().flat_map(move |strategy| {
            [1, 2].map(|threads| CalibrationRow {
                strategy: strategy.to_string(),
                threads,
                jobs: 200,
                seconds: start_s * threads as f64,
                cpu_s: None,
                started: threads,
                calibration: calibration as u32,
            })
        })
    };
    let rows: Vec<CalibrationRow> = starts.iter().copied().enumerate().flat_map(of_one).collect();
    csv_file::write(&out.path().join("an-experiment/calibration.csv"), rows).unwrap();
}

fn drawn(out: &TempDir) -> Vec<Block> {
    blocks(&Results::read(&Lab::built_in(), out.path(), &out.path().join("an-experiment")).unwrap()).unwrap()
}

fn notes(blocks: &[Block], name: &str) -> Option<Vec<Note>> {
    blocks.iter().find_map(|block| match block {
        Block::Figure { stem, figure } if *stem == name => Some(figure.drawing().notes),
        _ => None,
    })
}

fn findings(blocks: &[Block]) -> String {
    blocks.iter().filter_map(Block::as_finding).collect::<Vec<&str>>().join("\n")
}

const FORECAST: &str = "[figure.forecast]\ncores = [1, 2, 4]\ndecomposition = \"tiles:2x2\"";

/// Without overheads, static blocks on four workers end with the longest job: the speedups are 6/3, 12/9 and 5/2.
#[test]
fn a_forecast_has_the_differences_between_serial_runs_as_a_band() {
    let out = folder(&["forecast"], FORECAST);
    calibrate(&out, &[0.0]);
    let blocks = drawn(&out);
    let notes = notes(&blocks, "forecast-speedup").unwrap();
    let at_four = notes.iter().find(|note| note.series == "static-blocks" && note.of == "4").unwrap();
    let expected = crate::analysis::mean::geometric_interval(&[2.0, 12.0 / 9.0, 2.5], 0.95).unwrap();
    assert!((at_four.value - expected.value).abs() < 1e-9, "{at_four:?}");
    assert!((at_four.interval.unwrap().0 - expected.interval.low).abs() < 1e-9, "{at_four:?}");
    let one = super::tests::svg(&blocks, "forecast-speedup");
    assert!(one.contains("there is one") && one.contains("3 serial runs and 1"), "{one}");
    // With several calibrations nothing is left out, and the values change.
    calibrate(&out, &[0.0, 0.5, 0.1]);
    let blocks = drawn(&out);
    let text = super::tests::svg(&blocks, "forecast-speedup");
    assert!(text.contains("3 calibrations") && !text.contains("leaves out"), "{text}");
    let notes = self::notes(&blocks, "forecast-speedup").unwrap();
    let other = notes.iter().find(|note| note.series == "static-blocks" && note.of == "4").unwrap();
    assert!(other.value < at_four.value && other.interval.is_some(), "{other:?}");
}

/// Every job takes a quarter longer on two threads, so predictions without that are 20 % too fast, and right with it.
#[test]
fn errors_of_all_runs_are_told_with_and_without_work_inflation() {
    let out = folder(&["forecast"], FORECAST);
    calibrate(&out, &[0.0]);
    let told = findings(&drawn(&out));
    let all = told.find("Over all 6 runs: median absolute error").unwrap_or_else(|| panic!("{told}"));
    let modelled = told.find("With the work inflation of the other repetitions").unwrap();
    assert!(all < modelled, "{told}");
    assert!(told.contains("with 2 threads busy, the jobs took 1.25"), "{told}");
    let blocks = drawn(&out);
    let table = super::tests::table(&blocks);
    let place = |head: &str| table.heads().position(|own| own == head).unwrap();
    let own = table.rows().find(|row| row[0] == "static-blocks").unwrap();
    assert_eq!((&*own[place("error in all runs, %")], &*own[place("error with work inflation, %")]), ("-20.0", "0.0"));
}

/// A job of one run was disturbed for 8 seconds; its least time is 1 s. The longest least time is that of no job above 1.
#[test]
fn a_cost_map_shows_the_least_time_of_each_tile() {
    let told = findings(&drawn(&folder(&["cost-map"], "")));
    assert!(told.contains("takes 1000.00 ms, 1.0 times"), "{told}");
}

/// Threads that share processors have a figure with its own colours, and the serial run is told but not drawn.
#[test]
fn shared_processors_have_timelines_of_their_own() {
    let blocks = drawn(&folder(&["timelines"], ""));
    assert!(notes(&blocks, "timelines").is_some() && notes(&blocks, "timelines-oversubscribed").is_some());
    assert!(super::tests::svg(&blocks, "timelines").contains("Not drawn: serial"));
    assert!(super::tests::svg(&blocks, "timelines-oversubscribed").contains("waiting for a processor"));
}

/// The run with the median time is drawn, and a disturbed one only if there is no other.
#[test]
fn timelines_are_of_runs_that_nothing_disturbed() {
    let makespan_ms = |warnings: [&str; 3]| {
        let blocks = drawn(&folder_with(&["timelines"], "", warnings));
        let table = super::tests::table(&blocks);
        let place = |head: &str| table.heads().position(|own| own == head).unwrap();
        let own = table.rows().find(|row| row[0].contains("static-blocks")).unwrap();
        own[place("makespan, ms")].clone()
    };
    assert_eq!(makespan_ms([""; 3]), "6000.00");
    assert_eq!(makespan_ms(["drift(25 %)", "", ""]), "5000.00");
    assert_eq!(makespan_ms(["drift(25 %)"; 3]), "6000.00");
}
