//! `diff` and `run --baseline`: which cells got slower?

use crate::experiment::{TINY, write_tiny};
use crate::program::{Finished, finish, pathmark};
use assert_cmd::cargo::cargo_bin;
use pathmark::measure::SCHEMA;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

pub(crate) fn run(folder: &Path, arguments: &[&str], code: i32) -> Finished {
    finish(pathmark(folder, arguments)).with_code(code)
}

/// Writes rows as a sweep of another commit on the same machine would leave them. `times` gives the time of a cell's
/// repetition.
pub(crate) fn measured(folder: &Path, name: &str, times: impl Fn(&str, u32) -> f64) {
    let from = folder.join("base/tiny");
    let to = folder.join(name);
    fs::create_dir_all(&to).unwrap();
    fs::copy(from.join("machine.toml"), to.join("machine.toml")).unwrap();
    let mut reader = csv::Reader::from_path(from.join("records.csv")).unwrap();
    let heads = reader.headers().unwrap().clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let (cell, repetition, makespan) = (column("cell"), column("repetition"), column("makespan_s"));
    let mut writer = csv::Writer::from_path(to.join("records.csv")).unwrap();
    writer.write_record(&heads).unwrap();
    for row in reader.records() {
        let row = row.unwrap();
        let seconds = times(&row[cell], row[repetition].parse().unwrap()).to_string();
        writer
            .write_record(row.iter().enumerate().map(|(at, value)| if at == makespan { &seconds } else { value }))
            .unwrap();
    }
}

/// Times around a second, all different.
pub(crate) fn steady(cell: &str, repetition: u32) -> f64 {
    1.0 + 1e-3 * f64::from(repetition * 7 % 10) + 1e-6 * cell.len() as f64
}

pub(crate) fn base(folder: &Path) {
    write_tiny(folder, TINY);
    run(folder, &["run", "tiny.toml", "--repetitions", "10", "--out", "base"], 0);
    measured(folder, "old", steady);
}

pub(crate) fn json(finished: &Finished) -> Value {
    serde_json::from_str(&finished.out).unwrap_or_else(|error| panic!("{error} in {}", finished.out))
}

#[test]
fn slower_cells_fail_and_others_pass() {
    let folder = tempfile::tempdir().unwrap();
    base(folder.path());
    let verdicts = |name: &str, factor: f64, only: &'static str, options: &[&str], code: i32| {
        measured(folder.path(), name, move |cell, repetition| {
            let slowed = if cell.contains(only) { factor } else { 1.0 };
            slowed * steady(cell, repetition + 3)
        });
        let found = json(&run(folder.path(), &[&["diff", "old", name, "--json"], options].concat(), code));
        let cells = found["cells"].as_array().unwrap().clone();
        assert_eq!(cells.len(), 5);
        cells
            .into_iter()
            .filter(|cell| cell["cell"].as_str().unwrap().contains(only))
            .map(|cell| cell["change"].clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(verdicts("same", 1.0, "serial", &[], 0), ["same"]);
    assert_eq!(verdicts("slow", 1.05, "serial", &[], 1), ["slower"]);
    assert_eq!(verdicts("slow", 1.05, "serial", &["--fail-above", "3%"], 1), ["slower"]);
    assert_eq!(verdicts("slow", 1.05, "serial", &["--fail-above", "0.1"], 0), ["same"]);
    assert_eq!(verdicts("fast", 0.9, "work-stealing", &[], 0), ["faster", "faster"]);
    // The table has the same verdict as the JSON object.
    let text = run(folder.path(), &["diff", "old", "slow"], 1);
    assert!(text.out.contains("slower") && text.err.contains("1 cell got slower"), "{}{}", text.out, text.err);
    assert!(text.err.contains("not measured in turns"), "{}", text.err);
}

#[test]
fn too_little_evidence_is_undecided() {
    let folder = tempfile::tempdir().unwrap();
    base(folder.path());
    // Times that scatter by half decide nothing about a change by a tenth.
    measured(folder.path(), "wild", |cell, repetition| {
        1.1 * steady(cell, repetition) * (0.7 + 0.1 * f64::from(repetition * 3 % 10))
    });
    let found = json(&run(folder.path(), &["diff", "old", "wild", "--json"], 0));
    assert!(found["cells"].as_array().unwrap().iter().all(|cell| cell["change"] == "undecided"), "{found}");
    run(folder.path(), &["diff", "old", "wild", "--undecided", "fail"], 1);
}

#[test]
fn folders_that_do_not_compare_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    base(folder.path());
    let refused = |arguments: &[&str], said: &[&str]| {
        let finished = run(folder.path(), &[&["diff"], arguments].concat(), 2);
        assert!(said.iter().all(|text| finished.err.contains(text)), "{said:?} is not in {}", finished.err);
    };
    for limit in ["-1%", "x", "NaN", "inf", "%", ""] {
        refused(&["old", "base/tiny", "--fail-above", limit], &["fail-above"]);
    }
    refused(&["old", "nowhere"], &["nowhere"]);
    refused(&["old", "."], &["records.csv"]);
    // Rows of another size have no cell in common.
    run(folder.path(), &["run", "tiny.toml", "--full", "--repetitions", "1", "--out", "full"], 0);
    refused(&["old", "full/tiny"], &["new", "no cell in common"]);
    // Another machine, and another version of the columns.
    let text = fs::read_to_string(folder.path().join("old/machine.toml")).unwrap();
    let line = text.lines().find(|line| line.starts_with("cpu = ")).unwrap();
    measured(folder.path(), "moved", steady);
    fs::write(folder.path().join("moved/machine.toml"), text.replace(line, "cpu = \"Another\"")).unwrap();
    refused(&["old", "moved"], &["another machine", "--across-machines"]);
    run(folder.path(), &["diff", "old", "moved", "--across-machines"], 0);
    // A build that renders other bits.
    measured(folder.path(), "revised", steady);
    let revised = folder.path().join("revised/records.csv");
    let text = fs::read_to_string(&revised).unwrap();
    let (heads, row) = text.split_once('\n').unwrap();
    let checksum = heads.split(',').position(|head| head == "checksum").unwrap();
    let checksum =
        csv::ReaderBuilder::new().has_headers(false).from_reader(row.as_bytes()).records().next().unwrap().unwrap()
            [checksum]
            .to_string();
    fs::write(&revised, text.replace(&checksum, "0123456789abcdef")).unwrap();
    refused(&["old", "revised"], &["another image", "--across-revisions"]);
    run(folder.path(), &["diff", "old", "revised", "--across-revisions"], 0);
    let rows = fs::read_to_string(folder.path().join("old/records.csv")).unwrap();
    fs::create_dir(folder.path().join("ancient")).unwrap();
    fs::write(folder.path().join("ancient/records.csv"), rows.replace(&format!("\n{SCHEMA},"), "\n6,")).unwrap();
    refused(&["old", "ancient"], &["schema", "6"]);
}

/// Writes a shell script in another process. If it were open for writing here, a child that another test starts
/// meanwhile would hold it open, too, and until that child ends the script could not run.
fn write_script(path: &Path, text: &str) {
    let mut writer = Command::new("sh");
    writer.args(["-c", "printf '#!/bin/sh\n%s\n' \"$1\" >\"$0\" && chmod 755 \"$0\""]).arg(path).arg(text);
    assert!(writer.status().unwrap().success());
}

/// The same program behind a script, as another build.
fn other_build(folder: &Path) -> PathBuf {
    let script = folder.join("other");
    write_script(&script, &format!("exec {} \"$@\"", cargo_bin!("pathmark").display()));
    script
}

/// Cell, repetition, order and checksum of each row.
fn rows(folder: &Path) -> Vec<[String; 4]> {
    let mut reader = csv::Reader::from_path(folder.join("records.csv")).unwrap();
    let heads = reader.headers().unwrap().clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let columns = ["cell", "repetition", "run_order", "checksum"].map(column);
    let mut rows: Vec<_> =
        reader.records().map(|row| columns.map(|at| row.as_ref().unwrap()[at].to_string())).collect();
    rows.sort();
    rows
}

/// The small experiment with as few pairs as a process can have.
fn in_two_pairs() -> String {
    TINY.replace("repetitions = 3\n", "repetitions = 3\npairs = 2\n")
}

/// The limit is so large that times differ by less as soon as an interval has two ends. Five intervals that hold
/// together at every look need 11 repetitions for that: there, 2 * 2^n / (n + 1) reaches 2 / (.05 / 5).
#[test]
fn repetitions_go_on_until_it_is_known() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), &in_two_pairs());
    other_build(folder.path());
    let until = |out: &str, options: &[&str], code: i32| {
        let all = ["run", "tiny.toml", "--baseline", "./other", "--out", out];
        run(folder.path(), &[&all, options].concat(), code)
    };
    let huge = "1000000000%";
    let finished = until("out", &["--until", huge], 0);
    assert!(finished.err.contains("5 of 5 cells decided"), "{}", finished.err);
    assert_eq!(rows(&folder.path().join("out/tiny")).len(), 5 * 11 * 2);
    let compared = ["diff", "out/baseline/tiny", "out/tiny", "--json", "--fail-above", huge];
    let found = json(&run(folder.path(), &compared, 0));
    assert_eq!(found["sequential"], true);
    assert!(found["cells"].as_array().unwrap().iter().all(|cell| cell["change"] == "same"), "{found}");
    let markdown = compared.map(|word| if word == "--json" { "--markdown" } else { word });
    let markdown = run(folder.path(), &markdown, 0).out;
    assert_eq!(markdown.lines().filter(|line| line.contains("| same | ")).count(), 5, "{markdown}");
    // Fewer repetitions decide nothing, and neither does a time limit of zero.
    until("few", &["--until", huge, "--repetitions", "4"], 0);
    assert_eq!(rows(&folder.path().join("few/tiny")).len(), 5 * 4 * 2);
    until("short", &["--until", huge, "--max-time", "0s"], 0);
    assert_eq!(rows(&folder.path().join("short/tiny")).len(), 5 * 2);
    for (options, field) in [
        (["--until", "-1%"].as_slice(), "until"),
        (&["--until", "0"], "until"),
        (&["--until", "x"], "until"),
        (&["--until", "3%", "--max-time", "soon"], "max-time"),
    ] {
        let finished = until("new", options, 2);
        assert!(finished.err.contains(field) && !folder.path().join("new").exists(), "{}", finished.err);
    }
    let alone = run(folder.path(), &["run", "tiny.toml", "--max-time", "60s"], 2);
    assert!(alone.err.contains("--until"), "{}", alone.err);
}

/// Two builds are measured in turns; the other one is the same program behind a script.
#[test]
fn two_builds_are_measured_in_turns() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), &in_two_pairs());
    let script = other_build(folder.path());
    let finished = run(folder.path(), &["run", "tiny.toml", "--baseline", "./other", "--out", "out"], 0);
    assert!(finished.err.contains("pathmark diff"), "{}", finished.err);
    let rows = |name: &str| rows(&folder.path().join(name));
    assert_eq!(rows("out/baseline/tiny"), rows("out/tiny"));
    let found = run(folder.path(), &["diff", "out/baseline/tiny", "out/tiny", "--json", "--fail-above", "1000%"], 0);
    assert_eq!((&json(&found)["paired"], json(&found)["cells"].as_array().unwrap().len()), (&true.into(), 5));
    assert!(!found.err.contains("not measured in turns"));
    // Two sweeps in turns were not measured in turns with each other.
    run(folder.path(), &["run", "tiny.toml", "--baseline", "./other", "--out", "next"], 0);
    let is_paired = |old: &str, new: &str| {
        let found = run(folder.path(), &["diff", old, new, "--json", "--fail-above", "1000%"], 0);
        let paired = json(&found)["paired"].as_bool().unwrap();
        assert_eq!(found.err.contains("not measured in turns"), !paired, "{old} and {new}: {}", found.err);
        paired
    };
    for (old, new) in
        [("out/tiny", "next/tiny"), ("out/baseline/tiny", "next/tiny"), ("out/baseline/tiny", "next/baseline/tiny")]
    {
        assert!(!is_paired(old, new), "{old} and {new}");
    }
    // Older sweeps have no number, and other names. Their folders are a pair where the program left them, and nowhere
    // else.
    for name in ["out", "out/baseline", "next", "next/baseline"] {
        let path = folder.path().join(name).join("tiny/machine.toml");
        let text = fs::read_to_string(&path).unwrap();
        let kept: Vec<&str> = text.lines().filter(|line| !line.starts_with("sweep = ")).collect();
        assert_eq!(kept.len() + 1, text.lines().count(), "{text}");
        fs::write(&path, kept.join("\n").replace("\nbaseline = ", "\nagainst = ")).unwrap();
    }
    fs::rename(folder.path().join("out/baseline"), folder.path().join("out/against")).unwrap();
    assert!(is_paired("out/against/tiny", "out/tiny") && is_paired("out/tiny", "out/against/tiny"));
    assert!(!is_paired("out/against/tiny", "next/tiny") && !is_paired("out/tiny", "next/tiny"));
    // The same folder again, and files that are no builds of Pathmark.
    run(folder.path(), &["run", "tiny.toml", "--baseline", "./other", "--out", "out"], 2);
    for other in ["./nowhere", "tiny.toml", ".", "/bin/true", "/bin/sh"] {
        let finished = run(folder.path(), &["run", "tiny.toml", "--baseline", other, "--out", "new"], 2);
        assert!(finished.err.contains("baseline") && !folder.path().join("new").exists(), "{}", finished.err);
    }
    // A build whose cells fail gives failed rows, and the sweep goes on.
    let fails = format!("[ \"$2\" = --help ] && exec {} \"$@\"\necho hello", cargo_bin!("pathmark").display());
    write_script(&script, &fails);
    let finished = run(folder.path(), &["run", "tiny.toml", "--baseline", "./other", "--out", "new"], 1);
    assert!(finished.err.contains("15 of"), "{}", finished.err);
    assert_eq!(rows("new/tiny").len(), 5 * 3 * 2);
}

/// Instructions are counted beside the rows; counts that differ by a thousandth or less are equal. Without valgrind the
/// test says so and passes.
#[test]
fn instructions_are_counted_and_compared() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), TINY);
    let count =
        ["run", "tiny.toml", "--repetitions", "1", "--filter", "strategy=serial", "--count-instructions", "--out"];
    if Command::new("valgrind").arg("--version").output().is_err() {
        println!("no valgrind: instructions are not counted");
        let refused = run(folder.path(), &[&count[..], &["none"]].concat(), 3);
        assert!(refused.err.contains("valgrind") && !folder.path().join("none").exists(), "{}", refused.err);
        return;
    }
    run(folder.path(), &[&count[..], &["a"]].concat(), 0);
    run(folder.path(), &[&count[..], &["b"]].concat(), 0);
    let compare = |new: &str, code: i32| run(folder.path(), &["diff", "a/tiny", new, "--counts"], code);
    assert!(compare("b/tiny", 0).out.contains("0 of "), "two runs of one build");
    let path = folder.path().join("b/tiny/instructions.csv");
    let counted = fs::read_to_string(&path).unwrap();
    let more = |factor: f64| {
        let row = |line: &str| {
            let (cell, count) = line.rsplit_once(',').unwrap();
            let count = count.parse().map_or_else(|_| count.to_string(), |n: f64| format!("{:.0}", n * factor));
            format!("{cell},{count}\n")
        };
        fs::write(&path, counted.lines().map(row).collect::<String>()).unwrap();
    };
    more(1.01);
    assert!(compare("b/tiny", 0).out.contains("instructions"));
    more(1.1);
    assert!(compare("b/tiny", 1).err.contains("grew by more than 2 %"));
    fs::write(&path, "cell,instructions\nx,y\n").unwrap();
    assert!(compare("b/tiny", 2).err.contains("instructions.csv:2"));
}

/// Counts are compared exactly: a build that traces more rays for the same cells fails, and one that traces fewer does not.
#[test]
fn counts_that_grow_fail() {
    let folder = tempfile::tempdir().unwrap();
    base(folder.path());
    let rows = fs::read_to_string(folder.path().join("base/tiny/records.csv")).unwrap();
    let at = |name: &str| rows.lines().next().unwrap().split(',').position(|head| head == name).unwrap();
    let (rays, cell) = (at("rays"), at("cell"));
    let twice = || {
        let changed = rows.lines().enumerate().map(|(line, row)| {
            let mut values: Vec<String> = row.split(',').map(str::to_string).collect();
            if line > 0 && values[cell].ends_with("work-stealing/2t") {
                values[rays] = (2 * values[rays].parse::<u64>().unwrap()).to_string();
            }
            values.join(",") + "\n"
        });
        fs::write(folder.path().join("twice.csv"), changed.collect::<String>()).unwrap();
    };
    let compare = |old: &str, new: &str, options: &[&str], code: i32| {
        run(folder.path(), &[&["diff", old, new, "--counts"], options].concat(), code)
    };
    let same = json(&compare("base/tiny", "base/tiny", &["--json"], 0));
    // Five cells, five counts each.
    assert_eq!((&same["compared"], same["changed"].as_array().unwrap().len()), (&25.into(), 0));
    twice();
    let more = compare("base/tiny", "twice.csv", &[], 1);
    assert!(more.out.contains("2.0000 rays") && more.out.contains("1 of 25 counts changed"), "{}", more.out);
    assert!(more.err.contains("1 count grew by more than 2 %"), "{}", more.err);
    compare("base/tiny", "twice.csv", &["--fail-above", "100%"], 0);
    assert!(compare("twice.csv", "base/tiny", &[], 0).out.contains("0.5000 rays"));
}
