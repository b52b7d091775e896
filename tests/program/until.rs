//! `run --until`: as many repetitions as a goal needs.

use crate::diff::{json, run};
use crate::experiment::{TINY, write_tiny};
use crate::program::in_memory;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// A limit that every result meets as soon as it has an interval at every look, which needs eight values.
const HUGE: &str = "1000000000%";

/// The number of rows of each cell, by the end of its name.
fn counts(folder: &Path) -> BTreeMap<String, usize> {
    let mut reader = csv::Reader::from_path(folder.join("tiny/records.csv")).unwrap();
    let cell = reader.headers().unwrap().iter().position(|head| head == "cell").unwrap();
    let mut found = BTreeMap::new();
    for row in reader.records() {
        let row = row.unwrap();
        let (_, schedule) = row[cell].rsplit_once("tiles:8x8/").unwrap();
        *found.entry(schedule.to_string()).or_default() += 1;
    }
    found
}

fn all(count: usize) -> BTreeMap<String, usize> {
    let names = ["serial/1t", "static-blocks/1t", "static-blocks/2t", "work-stealing/1t", "work-stealing/2t"];
    names.into_iter().map(|name| (name.to_string(), count)).collect()
}

/// Replaces every row's time by `times` of its cell and repetition.
fn retime(folder: &Path, times: impl Fn(&str, u32) -> f64) {
    let path = folder.join("tiny/records.csv");
    let mut reader = csv::Reader::from_path(&path).unwrap();
    let heads = reader.headers().unwrap().clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let (cell, repetition, makespan) = (column("cell"), column("repetition"), column("makespan_s"));
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let mut writer = csv::Writer::from_path(&path).unwrap();
    writer.write_record(&heads).unwrap();
    for row in rows {
        let seconds = times(&row[cell], row[repetition].parse().unwrap()).to_string();
        writer
            .write_record(row.iter().enumerate().map(|(at, value)| if at == makespan { &seconds } else { value }))
            .unwrap();
    }
}

#[test]
fn repetitions_go_on_until_speedups_are_known_also_after_a_stop() {
    let folder = in_memory();
    write_tiny(folder.path(), TINY);
    let out = folder.path().join("out");
    let sweep = ["run", "tiny.toml", "--until", HUGE];
    let finished = run(folder.path(), &sweep, 0);
    assert!(finished.err.contains("5 of 5 cells decided"), "{}", finished.err);
    assert_eq!(counts(&out), all(8));
    let machine = fs::read_to_string(out.join("tiny/machine.toml")).unwrap();
    assert!(machine.contains("until = "), "{machine}");
    assert!(fs::read_to_string(out.join("report.html")).unwrap().contains("Repetitions went on until the goal"));
    // Stopped after 17 rows, then resumed.
    let records = out.join("tiny/records.csv");
    let text = fs::read_to_string(&records).unwrap();
    fs::write(&records, text.split_inclusive('\n').take(18).collect::<String>()).unwrap();
    run(folder.path(), &[&sweep[..], &["--resume"]].concat(), 0);
    assert_eq!(counts(&out), all(8));
    // A sweep whose number of rows depends on its times cannot be resumed with a fixed number of repetitions.
    let finished = run(folder.path(), &["run", "tiny.toml", "--resume"], 2);
    assert!(finished.err.contains("until"), "{}", finished.err);
}

/// Only one cell's times scatter: that cell and the serial run continue, all others stop.
#[test]
fn known_cells_are_left_out_and_their_baselines_are_not() {
    let folder = in_memory();
    write_tiny(folder.path(), TINY);
    let out = folder.path().join("out");
    run(folder.path(), &["run", "tiny.toml", "--until", HUGE], 0);
    let drift = |repetition: u32| 1.0 + f64::from(repetition % 3);
    retime(&out, |cell, repetition| {
        let scatter = if cell.ends_with("work-stealing/2t") { f64::from(1 << (repetition % 8)) } else { 2.0 };
        if cell.ends_with("serial/1t") { drift(repetition) } else { drift(repetition) * scatter }
    });
    run(folder.path(), &["run", "tiny.toml", "--until", "1%", "--repetitions", "10", "--resume"], 0);
    let mut expected = all(8);
    expected.extend([("serial/1t".to_string(), 10), ("work-stealing/2t".to_string(), 10)]);
    assert_eq!(counts(&out), expected);
}

/// Five schedules need nine repetitions before one can be known to be slower than another: with four comparisons of the
/// fastest, the stake 2^(n + 1) / (n + 1) must reach 80; it is 56.9 after eight and 102.4 after nine. Two schedules are
/// the fastest in turns; they stay, and so does the serial run.
#[test]
fn who_is_slower_is_left_out() {
    let folder = in_memory();
    write_tiny(folder.path(), TINY);
    let out = folder.path().join("out");
    let sweep = |most: &str, resume: &[&str]| {
        let options = ["run", "tiny.toml", "--until", "fastest", "--repetitions", most];
        run(folder.path(), &[&options[..], resume].concat(), 0);
    };
    sweep("1", &[]);
    assert_eq!(counts(&out), all(1));
    sweep("9", &["--resume"]);
    let times = |cell: &str, repetition: u32| match cell {
        _ if cell.ends_with("/1t") => 2.0,
        _ => [1.0, 1.1][(repetition as usize + usize::from(cell.ends_with("work-stealing/2t"))) % 2],
    };
    retime(&out, times);
    sweep("12", &["--resume"]);
    let mut expected = all(9);
    expected.extend(["serial/1t", "static-blocks/2t", "work-stealing/2t"].map(|name| (name.to_string(), 12)));
    assert_eq!(counts(&out), expected);
    retime(&out, times);
    let found = json(&run(folder.path(), &["rank", "out/tiny", "--json"], 0));
    let fastest: Vec<&str> =
        found["images"][0]["fastest"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    assert!(fastest.len() == 2 && fastest.iter().all(|name| name.ends_with("2t")), "{found}");
    let printed = run(folder.path(), &["rank", "out/tiny"], 0);
    assert!(printed.out.contains("with 95 % confidence, the fastest of them is among: "), "{}", printed.out);
    let baseline = env!("CARGO_BIN_EXE_pathmark");
    let refused =
        run(folder.path(), &["run", "tiny.toml", "--until", "order", "--baseline", baseline, "--out", "other"], 2);
    assert!(refused.err.contains("order") && refused.err.contains("3%"), "{}", refused.err);
    let part = ["run", "tiny.toml", "--shard", "1/2", "--out", "part"];
    let refused = run(folder.path(), &[&part[..], &["--until", "fastest"]].concat(), 2);
    assert!(refused.err.contains("only some"), "{}", refused.err);
    // A shard of a sweep whose definition has such a goal runs the goal's largest number of repetitions.
    write_tiny(
        folder.path(),
        &TINY.replacen("repetitions = 3", "repetitions = { until = \"fastest\", at-most = 2 }", 1),
    );
    run(folder.path(), &part, 0);
    let machine = fs::read_to_string(folder.path().join("part/tiny/machine.toml")).unwrap();
    assert!(!machine.contains("until"), "{machine}");
}

/// A matrix's number of repetitions holds unless the command line gives another.
#[test]
fn a_matrix_has_fewer_repetitions_than_its_experiment() {
    let folder = in_memory();
    let text = TINY.replacen("[matrix]", "[matrix]\nrepetitions = 2", 1);
    write_tiny(folder.path(), &text);
    for (options, count) in [(["--out", "own"].as_slice(), 2), (&["--repetitions", "3", "--out", "told"], 3)] {
        run(folder.path(), &[&["run", "tiny.toml"], options].concat(), 0);
        assert_eq!(counts(&folder.path().join(options.last().unwrap())), all(count));
        let printed = run(folder.path(), &["rank", &format!("{}/tiny", options.last().unwrap())], 0);
        let said = if count == 2 { "too few schedules have all repetitions" } else { "any of them may be the fastest" };
        assert!(printed.out.contains(said), "{}", printed.out);
    }
    write_tiny(folder.path(), &text.replace("repetitions = 2", "repetitions = 0"));
    let refused = run(folder.path(), &["run", "tiny.toml", "--out", "none"], 2);
    assert!(refused.err.contains("tiny.toml:") && refused.err.contains("repetitions"), "{}", refused.err);
}

#[test]
fn an_experiment_says_until_when() {
    let folder = in_memory();
    let until = |what: &str| TINY.replacen("repetitions = 3", &format!("repetitions = {what}"), 1);
    write_tiny(folder.path(), &until(&format!("{{ until = \"{HUGE}\", at-most = 9, max-time = \"90 min\" }}")));
    run(folder.path(), &["run", "tiny.toml"], 0);
    assert_eq!(counts(&folder.path().join("out")), all(8));
    // The key's name in version 0.1.
    write_tiny(folder.path(), &until("{ until = \"1 %\", at-most = 9, within = \"0 s\" }"));
    run(folder.path(), &["run", "tiny.toml", "--out", "old"], 0);
    assert_eq!(counts(&folder.path().join("old")), all(1));
    for (wrong, said) in [
        ("{ until = \"-1 %\" }", "until"),
        ("{ until = \"0\" }", "until"),
        ("{ until = \"1 %\", max-time = \"soon\" }", "max-time"),
        ("{ until = \"1 %\", at-most = 0 }", "repetitions"),
        ("{ until = \"1 %\", mood = 1 }", "at-most"),
        ("\"often\"", "at-most"),
    ] {
        write_tiny(folder.path(), &until(wrong));
        let finished = run(folder.path(), &["run", "tiny.toml", "--out", "wrong"], 2);
        assert!(finished.err.contains(said) && finished.err.contains("tiny.toml:"), "{wrong}: {}", finished.err);
    }
    assert!(!folder.path().join("wrong").exists());
}
