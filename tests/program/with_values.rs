//! `run --set` and `run --filter`: other values for an experiment, or a part of it, without editing it.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, in_memory, pathmark};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

type Row = BTreeMap<String, String>;

fn run(folder: &Path, arguments: &[&str]) -> Vec<Row> {
    let base = ["run", "tiny.toml", "--out", "out", "--repetitions", "1"];
    finish(pathmark(folder, &[&base, arguments].concat())).with_code(0);
    rows(&folder.join("out/tiny/records.csv"))
}

fn rows(path: &Path) -> Vec<Row> {
    csv::Reader::from_path(path).unwrap().into_deserialize().collect::<csv::Result<_>>().unwrap()
}

fn values<'a>(rows: &'a [Row], column: &str) -> BTreeSet<&'a str> {
    rows.iter().map(|row| row[column].as_str()).collect()
}

#[test]
fn values_are_set_in_every_matrix_and_profile() {
    let folder = in_memory();
    write_tiny(folder.path(), &TINY.replace("repetitions = 3", "repetitions = 3\nspp = [8]"));
    let rows = run(
        folder.path(),
        &["--set", "threads=1,3", "--set", "spp=4,12", "--set", "scene=cornell-diffuse", "--set", "size=20x10"],
    );
    assert_eq!(values(&rows, "spp"), BTreeSet::from(["4", "12"]));
    assert_eq!(values(&rows, "threads"), BTreeSet::from(["1", "3"]));
    assert_eq!(values(&rows, "width"), BTreeSet::from(["20"]));
    // Serial once, two strategies on one and three threads; two numbers of samples.
    assert_eq!(rows.len(), 10);
}

/// A matrix's own size comes before that of the profile, so the user is told that it stays.
#[test]
fn sizes_that_stay_are_told() {
    let folder = in_memory();
    write_tiny(folder.path(), &TINY.replace("[matrix]", "[matrix]\nsize = [20, 12]"));
    let told = |values: &str| {
        let arguments = ["run", "tiny.toml", "--plan", "--set", values];
        finish(pathmark(folder.path(), &arguments)).with_code(0).err.contains("keep it: 20x12")
    };
    assert!(told("seed=2") && !told("size=16x8"));
}

/// The definition beside the rows is the experiment that was run.
#[test]
fn the_definition_beside_the_rows_has_the_values() {
    let folder = in_memory();
    write_tiny(folder.path(), TINY);
    let first = run(folder.path(), &["--set", "spp=12"]);
    let kept = folder.path().join("out/tiny/experiment.toml");
    let text = std::fs::read_to_string(&kept).unwrap();
    assert!(text.starts_with("# tiny.toml with --set spp=12\n"), "{text}");
    let again = ["run", "out/tiny/experiment.toml", "--out", "again", "--repetitions", "1"];
    finish(pathmark(folder.path(), &again)).with_code(0);
    let second = rows(&folder.path().join("again/experiment/records.csv"));
    assert_eq!(values(&first, "cell"), values(&second, "cell"));
}

/// Without its serial run, a speedup would be an empty figure.
#[test]
fn filters_take_several_values_and_leave_serial_runs_in() {
    let folder = in_memory();
    write_tiny(folder.path(), TINY);
    let rows = run(folder.path(), &["--filter", "strategy=work-stealing,static-blocks", "--filter", "threads=2"]);
    let cells: BTreeSet<(&str, &str)> = rows.iter().map(|row| (&*row["strategy"], &*row["threads"])).collect();
    assert_eq!(cells, BTreeSet::from([("serial", "1"), ("static-blocks", "2"), ("work-stealing", "2")]));
}

/// Only fields without a default must be given.
#[test]
fn an_experiment_of_few_lines_runs() {
    let folder = in_memory();
    let lines = "title = \"Short\"\nquestion = \"Does it run?\"\nfigures = [\"schedules\"]\n[matrix]\nscene = [\"cornell\"]\n\
        spp = [4]\nstrategy = [\"serial\"]\nthreads = [1]\ndecomposition = [\"rows\"]\n[reference]\nestimator = \"bsdf\"\n";
    write_tiny(folder.path(), lines);
    let rows = run(folder.path(), &[]);
    assert_eq!(values(&rows, "width"), BTreeSet::from(["320"]));
    assert!(rows[0]["rmse"].parse::<f64>().unwrap() > 0.0, "errors are measured against a reference: {rows:?}");
}
