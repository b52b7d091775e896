//! Invalid trace files, and options of `simulate` and `trace` that make no sense.

use super::program::{finish, in_memory, pathmark};
use super::refused;
use std::fs;

const RENDER: [&str; 10] =
    ["render", "cornell", "--size", "24x16", "--spp", "4", "--decomposition", "tiles:8x8", "--trace", "run.csv"];

#[test]
fn a_damaged_trace_is_refused_with_its_line() {
    let folder = in_memory();
    finish(pathmark(folder.path(), &RENDER)).with_code(0);
    let path = folder.path().join("run.csv");
    let whole = fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = whole.lines().collect();
    let second_job = lines[3];
    let cases = [
        (String::new(), "run.csv:1:"),
        ("job,worker\n0,0\n".to_string(), "run.csv:1:"),
        (whole.replacen("\"spp\"", "\"ssp\"", 1), "run.csv:1:"),
        (whole.replacen("\"workers\":", "\"workers\":4000000", 1), "run.csv:1:"),
        (whole.replacen("\"makespan_s\":", "\"makespan_s\":-", 1), "run.csv:1:"),
        (whole.replace(second_job, &second_job.replacen(",0,", ",9,", 1).replacen(",1,", ",9,", 1)), "run.csv:4:"),
        (lines[..2].join("\n"), "run.csv:2:"),
        (whole.replace(second_job, &second_job.replacen('1', "7", 1)), "run.csv:4:"),
        (whole.replace(second_job, "1,0,0.5,0.25,1,1,0,0,8,8,0,4"), "run.csv:4:"),
        (whole.replace(second_job, "1,0,0.5,NaN,1,1,0,0,8,8,0,4"), "run.csv:4:"),
        (whole.replace(second_job, "1,0,0.5"), "run.csv:4:"),
    ];
    for (text, place) in cases {
        fs::write(&path, &text).unwrap();
        for arguments in
            [&["inspect", "jobs", "run.csv", "-o", "run.svg"][..], &["simulate", "run.csv", "--out", "new"]]
        {
            refused(folder.path(), arguments, 2, &[place]);
        }
    }
}

/// The settings in a trace are run to predict this machine. They are checked before anything is written.
#[test]
fn a_trace_that_asks_for_too_many_jobs_is_refused() {
    let folder = in_memory();
    finish(pathmark(folder.path(), &RENDER)).with_code(0);
    let path = folder.path().join("run.csv");
    let text = fs::read_to_string(&path).unwrap();
    let enormous = text.replace("\"spp\":4", "\"spp\":16777216").replace("tiles:8x8", "samples:16:1x1");
    fs::write(&path, enormous).unwrap();
    refused(folder.path(), &["simulate", "run.csv", "--out", "new"], 2, &["decomposition", "402653184 jobs"]);
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let folder = in_memory();
    finish(pathmark(folder.path(), &RENDER)).with_code(0);
    let cases: [(&[&str], &[&str]); 10] = [
        (&["--slow-core", "8"], &["slow-core", "8", "0.01 to 1"]),
        (&["--strategies", "thread-per-row"], &["strategy", "thread-per-row", "thread-per-job"]),
        (&["--workers", "0"], &["workers", "0", "1.."]),
        (&["--workers", "8..2"], &["workers", "8..2"]),
        (&["--workers", "many"], &["workers", "many"]),
        (&["--slow-core", "0"], &["slow-core", "0"]),
        (&["--slow-core", "NaN"], &["slow-core", "NaN"]),
        (&["--efficiency-cores", "4"], &["efficiency-cores", "4"]),
        (&["--strategies", "magic"], &["strategy", "magic", "work-stealing"]),
        (&["--strategies", "dynamic:x"], &["dynamic"]),
    ];
    for (options, said) in cases {
        refused(folder.path(), &[&["simulate", "run.csv", "--out", "new"][..], options].concat(), 2, said);
    }
    refused(folder.path(), &["inspect", "jobs", "run.csv", "-o", "run.gif"], 2, &["run.gif", ".svg", ".json"]);
    refused(folder.path(), &["inspect", "jobs", "none.csv"], 2, &["none.csv"]);
    refused(folder.path(), &["simulate", "none.csv"], 2, &["none.csv"]);
}

/// A render that could not write its trace is refused before it starts.
#[test]
fn a_trace_that_cannot_be_written_is_refused_at_once() {
    let folder = in_memory();
    let arguments = ["render", "cornell", "--trace", "no/such/folder/run.csv"];
    refused(folder.path(), &arguments, 2, &["no/such/folder/run.csv", "does not exist"]);
}

#[test]
fn references_need_a_deterministic_sampler() {
    let folder = in_memory();
    let arguments = ["image", "reference", "cornell", "--spp", "4", "--sampler", "per-thread"];
    refused(folder.path(), &arguments, 2, &["sampler", "per-thread", "independent"]);
}

#[test]
fn split_samples_and_the_subpixel_clamp_exclude_each_other() {
    let folder = in_memory();
    let arguments = ["render", "cornell", "--clamp", "subpixel", "--decomposition", "samples:16"];
    refused(folder.path(), &arguments, 2, &["decomposition", "samples:16", "clamp"]);
}
