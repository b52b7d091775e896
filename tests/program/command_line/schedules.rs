//! A run's schedule and its uses: traces, timelines, forecasts.

use super::{json, run};
use crate::experiment::{TINY, write_tiny};
use crate::program::in_memory;
use std::fs;
use std::path::Path;

/// The heading of the table of predictions.
const PREDICTED: &str = "The simulator predicts this machine";

const SIZE: [&str; 6] = ["--size", "24x16", "--spp", "4", "--decomposition", "tiles:8x8"];

/// Renders `cornell` in six tiles, with a trace in `run.csv`.
fn traced(folder: &Path, strategy: &str, threads: &str) {
    let who = ["--strategy", strategy, "--threads", threads, "--trace", "run.csv"];
    run(folder, &[&["render", "cornell"][..], &SIZE, &who].concat());
}

#[test]
fn a_trace_has_a_row_for_each_job_and_can_be_drawn() {
    let folder = in_memory();
    traced(folder.path(), "static-cyclic", "2");
    let text = fs::read_to_string(folder.path().join("run.csv")).unwrap();
    let mut lines = text.lines();
    let header = json(lines.next().unwrap().trim_start_matches("# "));
    assert_eq!(header["settings"]["strategy"], "static-cyclic");
    let rows: Vec<Vec<&str>> = lines.skip(1).map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 6);
    let column = |index: usize| rows.iter().map(|row| row[index].parse::<f64>().unwrap()).collect::<Vec<_>>();
    let (workers, paths) = (column(1), column(4));
    // The cyclic assignment alternates between the two workers.
    assert!(workers.windows(2).all(|pair| pair[0] != pair[1]), "{workers:?}");
    assert!(paths.iter().all(|paths| *paths == 256.0), "{paths:?}");
    let makespan = header["makespan_s"].as_f64().unwrap();
    assert!(column(2).iter().zip(column(3)).all(|(start, stop)| 0.0 <= *start && *start < stop && stop <= makespan));

    let said = run(folder.path(), &["inspect", "jobs", "run.csv", "-o", "run.svg"]).out;
    assert!(said.contains("6 jobs on 2 workers"), "{said}");
    // A line for each worker: its times add up to the makespan.
    let of_workers: Vec<&str> = said.lines().filter(|line| line.starts_with("worker ")).collect();
    assert_eq!(of_workers.len(), 2, "{said}");
    for line in of_workers {
        assert!(line.contains(": 3 jobs, busy "), "{said}");
        let times = line.split([' ', ',']).filter_map(|word| word.parse::<f64>().ok()).skip(1);
        let sum: f64 = times.sum();
        assert!((sum - 1e3 * makespan).abs() < 0.01, "{sum}: {said}");
    }
    assert!(fs::read_to_string(folder.path().join("run.svg")).unwrap().contains("static-cyclic"));
    run(folder.path(), &["inspect", "jobs", "run.csv", "-o", "run.json"]);
    let events = json(&fs::read_to_string(folder.path().join("run.json")).unwrap());
    let complete = events["traceEvents"].as_array().unwrap().iter().filter(|event| event["ph"] == "X").count();
    assert_eq!(complete, 6);
    run(folder.path(), &["inspect", "jobs", "run.csv", "-o", "run.png"]);
}

/// Asserts that a chart has a line, or a part of one, for each of these names.
fn drawn(chart: &Path, names: &[&str]) {
    let chart = fs::read_to_string(chart).unwrap();
    for name in names {
        let is_drawn = |tag: &str| tag.contains(name) && tag.starts_with("series\" data-series=");
        assert!(chart.split("<g class=\"").any(is_drawn), "{name} is not drawn");
    }
}

/// Strategies that the user names are drawn, also if their lines are close, in every way to name several.
#[test]
fn every_strategy_that_is_named_is_drawn() {
    let folder = in_memory();
    traced(folder.path(), "serial", "1");
    let simulate = ["simulate", "run.csv", "--no-check", "--workers", "1,2,4"];
    let chosen =
        ["--strategies", "serial", "--strategies", "shared-counter", "--strategies", "dynamic:2,shared-counter"];
    run(folder.path(), &[&simulate[..], &chosen].concat());
    drawn(&folder.path().join("out/simulation/forecast-speedup.svg"), &["serial", "shared-counter", "dynamic:2"]);
    let table = fs::read_to_string(folder.path().join("out/simulation/forecast.csv")).unwrap();
    assert_eq!(table.lines().filter(|line| line.starts_with("shared-counter,")).count(), 3, "{table}");
    run(folder.path(), &[&simulate[..], &chosen[2..], &["--ranks", "static-cyclic", "--nodes", "2"]].concat());
    let within = ["4 threads by shared-counter", "4 threads by dynamic:2"];
    drawn(&folder.path().join("out/simulation/ranks-forecast.svg"), &within);
    let table = fs::read_to_string(folder.path().join("out/simulation/ranks-forecast.csv")).unwrap();
    assert_eq!(table.lines().filter(|line| line.starts_with("static-cyclic,2,1,")).count(), 1, "{table}");
}

/// Predicts this machine, then forecasts others.
#[test]
fn a_trace_is_replayed_on_other_machines() {
    let folder = in_memory();
    traced(folder.path(), "serial", "1");
    let chosen = ["--strategies", "static-blocks,shared-counter,dynamic:2", "--workers", "1,2,1000"];
    let said = run(folder.path(), &[&["simulate", "run.csv", "--out", "forecast"][..], &chosen].concat()).out;
    assert!(said.contains(PREDICTED), "{said}");
    let table = fs::read_to_string(folder.path().join("forecast/forecast.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let names: Vec<&str> = rows.iter().map(|row| row[0]).collect();
    let expected = ["static-blocks", "shared-counter", "dynamic:2", "longest-first"];
    assert_eq!(names, expected.map(|name| [name; 3]).concat());
    drawn(&folder.path().join("forecast/forecast-speedup.svg"), &expected[..3]);

    let slower = ["simulate", "run.csv", "--no-check", "--workers", "2", "--slow-core", "0.5"];
    let said = run(folder.path(), &slower).out;
    assert!(!said.contains(PREDICTED), "{said}");
}

/// Jobs of several workers are replayed all the same.
#[test]
fn a_trace_of_several_workers_is_warned_about() {
    let folder = in_memory();
    let simulate = ["simulate", "run.csv", "--no-check", "--workers", "2", "--strategies", "shared-counter"];
    let warned = |strategy: &str, threads: &str| {
        traced(folder.path(), strategy, threads);
        run(folder.path(), &simulate).err.contains("warning: this trace is of 2 workers")
    };
    assert_eq!((warned("static-cyclic", "2"), warned("serial", "1")), (true, false));
}

/// A strategy that cannot run on this machine, a thread for each of 19200 pixels, is skipped with a message and
/// simulated all the same.
#[test]
fn jobs_too_many_for_threads_are_simulated() {
    let folder = in_memory();
    let cut = ["--size", "160x120", "--spp", "4", "--decomposition", "tiles:1x1", "--trace", "run.csv"];
    run(folder.path(), &[&["render", "cornell", "--strategy", "serial"][..], &cut].concat());
    let chosen = ["--strategies", "thread-per-job,shared-counter", "--workers", "4"];
    let finished = run(folder.path(), &[&["simulate", "run.csv", "--out", "forecast"][..], &chosen].concat());
    assert!(finished.err.contains("thread-per-job is not tried"), "{}", finished.err);
    assert!(finished.out.contains("shared-counter"), "{}", finished.out);
    let chart = fs::read_to_string(folder.path().join("forecast/forecast-speedup.svg")).unwrap();
    assert!(!chart.contains("no data"));
}

/// An experiment that keeps traces is predicted from its own rows.
#[test]
fn an_experiment_with_traces_is_predicted_from_its_rows() {
    let folder = in_memory();
    let text =
        TINY.replace("figures = [\"speedup\", ", "keep = [\"traces\", \"calibration\"]\nfigures = [\"forecast\", ");
    write_tiny(folder.path(), &text);
    run(folder.path(), &["run", "tiny.toml", "--out", "out"]);
    assert_eq!(fs::read_dir(folder.path().join("out/tiny/traces")).unwrap().count(), 15);
    let said = run(folder.path(), &["simulate", "out/tiny", "--workers", "1..4"]).out;
    let table = said.split_once(PREDICTED).unwrap_or_else(|| panic!("{said}")).1;
    // The accuracy of a prediction depends on the machine, which may be disturbed. The presence of each schedule does
    // not.
    let predicted = table.lines().filter(|line| line.contains("tiles:8x8")).count();
    assert_eq!(predicted, 4, "{said}");
}

/// No figure fails because its data are missing: a schedule that was not run, an error that was not measured.
#[test]
fn every_figure_makes_do_with_any_rows() {
    let names: Vec<String> = pathmark::report::FIGURES
        .iter()
        .filter(|entry| !["contact-sheet", "rmse-against-spp", "rmse-against-time"].contains(&entry.name))
        .map(|entry| format!("\"{}\"", entry.name))
        .collect();
    let figures = format!("figures = [{}]", names.join(", "));
    let folder = in_memory();
    let bare = TINY.replace("figures = [\"speedup\", \"schedules\"]", &figures);
    let kept = bare.replace("[matrix]", "keep = [\"traces\", \"calibration\"]\n\n[matrix]");
    let check_page = |out: &str| {
        let page = fs::read_to_string(folder.path().join(out).join("report.html")).unwrap();
        assert!(page.contains("Tiny") && !page.contains("NaN"), "{out}");
    };
    for (index, text) in [bare, kept].iter().enumerate() {
        write_tiny(folder.path(), text);
        let out = format!("out{index}");
        run(folder.path(), &["run", "tiny.toml", "--repetitions", "2", "--out", &out]);
        check_page(&out);
    }
    // A sweep of one strategy alone, or one whose serial runs all failed, has nothing to compare with.
    let rows = folder.path().join("out0/tiny/records.csv");
    let text = fs::read_to_string(&rows).unwrap();
    let kept: Vec<&str> = text.lines().filter(|line| !line.contains("/serial/")).collect();
    assert!(kept.len() > 1 && kept.len() < text.lines().count());
    fs::write(&rows, kept.join("\n") + "\n").unwrap();
    run(folder.path(), &["report", "out0"]);
    check_page("out0");
}
