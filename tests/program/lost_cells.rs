//! `diff`: cells and experiments that the new measurement lost, and names that a terminal would obey.

use crate::diff::{base, json, measured, run, steady};
use crate::program::in_memory;
use std::fs;
use std::path::Path;

/// Copies the rows of `from` to the folder `to` after a change of their fields; a row for which `change` returns false
/// is left out. `change` gets the row's fields by column.
fn changed(folder: &Path, from: &str, to: &str, change: impl Fn(&dyn Fn(&str) -> usize, &mut Vec<String>) -> bool) {
    let (from, to) = (folder.join(from), folder.join(to));
    fs::create_dir_all(&to).unwrap();
    fs::copy(from.join("machine.toml"), to.join("machine.toml")).unwrap();
    let mut reader = csv::Reader::from_path(from.join("records.csv")).unwrap();
    let heads = reader.headers().unwrap().clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let mut writer = csv::Writer::from_path(to.join("records.csv")).unwrap();
    writer.write_record(&heads).unwrap();
    for row in reader.records() {
        let mut fields: Vec<String> = row.unwrap().iter().map(str::to_string).collect();
        if change(&column, &mut fields) {
            writer.write_record(&fields).unwrap();
        }
    }
}

/// The names that an error tells, in the order of the table.
fn told<'a>(text: &'a str, before: &str) -> Vec<&'a str> {
    let (_, names) = text.split_once(before).unwrap_or_else(|| panic!("{before} is not in {text}"));
    let (names, _) = names.split_once(['\n', ';']).unwrap_or((names, ""));
    names.split(", ").collect()
}

#[test]
fn cells_that_vanished_make_the_comparison_fail() {
    let folder = in_memory();
    base(folder.path());
    changed(folder.path(), "old", "fewer", |column, row| row[column("strategy")] != "work-stealing");
    for options in [&[][..], &["--undecided", "fail"], &["--counts"]] {
        let found = run(folder.path(), &[&["diff", "old", "fewer"], options].concat(), 1);
        let names = told(&found.err, "2 cells missing in the new measurement: ");
        assert!(names.len() == 2 && names.iter().all(|name| name.contains("/work-stealing/")), "{}", found.err);
        assert!(!found.err.contains("failed in"), "{}", found.err);
    }
    let found = json(&run(folder.path(), &["diff", "old", "fewer", "--json"], 1));
    let count = |key: &str| found[key].as_array().unwrap().len();
    assert_eq!((count("cells"), count("missing"), count("failed")), (3, 2, 0), "{found}");
    assert!(run(folder.path(), &["diff", "old", "fewer"], 1).out.contains(" missing "));
    // A cell that is new is told, and makes nothing fail.
    let more = run(folder.path(), &["diff", "fewer", "old"], 0);
    assert!(more.err.contains("0 cells of the old and 2 cells of the new"), "{}", more.err);
}

#[test]
fn cells_that_failed_make_the_comparison_fail() {
    let folder = in_memory();
    base(folder.path());
    let failing = |name: &str, is_failed: &dyn Fn(&str, u32) -> bool| {
        changed(folder.path(), "old", name, |column, row| {
            if is_failed(&row[column("strategy")], row[column("repetition")].parse().unwrap()) {
                row[column("error")] = "it broke".to_string();
                row[column("makespan_s")].clear();
            }
            true
        });
    };
    // The checksum of a failed row may be that of another image.
    changed(folder.path(), "old", "other-bits", |column, row| {
        if row[column("strategy")] == "serial" && row[column("repetition")] == "7" {
            row[column("checksum")] = "0123456789abcdef".to_string();
            row[column("error")] = "checksum 0123456789abcdef".to_string();
        }
        true
    });
    assert!(run(folder.path(), &["diff", "old", "other-bits"], 1).err.contains("(1 of 10 rows: checksum 0123"));
    failing("all", &|strategy, _| strategy == "static-blocks");
    failing("one", &|strategy, repetition| strategy == "static-blocks" && repetition == 4);
    for (name, rows, cells) in [("all", "10 of 10 rows", 3), ("one", "1 of 10 rows", 5)] {
        for options in [&[][..], &["--counts"]] {
            let found = run(folder.path(), &[&["diff", "old", name], options].concat(), 1);
            let names = told(&found.err, "2 cells failed in the new measurement: ");
            let is_told =
                |name: &&str| name.contains("/static-blocks/") && name.ends_with(&format!("({rows}: it broke)"));
            assert!(names.len() == 2 && names.iter().all(is_told), "{}", found.err);
            assert!(!found.err.contains("missing"), "{}", found.err);
        }
        let found = json(&run(folder.path(), &["diff", "old", name, "--json"], 1));
        let count = |key: &str| found[key].as_array().unwrap().len();
        assert_eq!((count("cells"), count("missing"), count("failed")), (cells, 0, 2), "{found}");
    }
    // Cells that failed before, and work now or still fail, are no loss.
    run(folder.path(), &["diff", "all", "old"], 0);
    run(folder.path(), &["diff", "one", "all"], 1);
    run(folder.path(), &["diff", "all", "all"], 0);
    run(folder.path(), &["diff", "one", "one"], 0);
    // Even if nothing is left to compare.
    failing("none", &|_, _| true);
    let found = run(folder.path(), &["diff", "old", "none"], 1);
    assert!(found.err.contains("5 cells failed in the new measurement"), "{}", found.err);
}

/// Two folders of `--out` are compared experiment by experiment, with one error probability for all.
#[test]
fn folders_of_experiments_are_compared_by_name() {
    let folder = in_memory();
    base(folder.path());
    for (name, factor) in [("one/a", 1.0), ("one/b", 1.0), ("two/a", 1.0), ("two/b", 1.2), ("two/c", 1.0)] {
        measured(folder.path(), name, |cell, repetition| factor * steady(cell, repetition));
    }
    fs::create_dir(folder.path().join("two/references")).unwrap();
    let found = run(folder.path(), &["diff", "one", "two", "--json"], 1);
    let object = json(&found);
    let experiments = object["experiments"].as_array().unwrap();
    let changes: Vec<(&str, &str)> = experiments
        .iter()
        .flat_map(|own| own["cells"].as_array().unwrap().iter().map(move |cell| (own, cell)))
        .map(|(own, cell)| (own["experiment"].as_str().unwrap(), cell["change"].as_str().unwrap()))
        .collect();
    assert_eq!(changes, [[("a", "same"); 5], [("b", "slower"); 5]].concat());
    assert_eq!((&object["only_old"], &object["only_new"]), (&json_of("[]"), &json_of("[\"c\"]")));
    // Ten intervals hold together: each has at least the confidence 1 - .05 / 10.
    let level = experiments[0]["cells"][0]["interval"]["level"].as_f64().unwrap();
    assert!(level >= 0.995, "{level}");
    assert!(
        found.err.contains("experiment c: only the new") && found.err.contains("5 cells got slower"),
        "{}",
        found.err
    );
    let back = run(folder.path(), &["diff", "two", "one", "--fail-above", "1%"], 1);
    assert!(back.err.contains("1 experiment missing in the new measurement: c"), "{}", back.err);
    assert_eq!(back.out.lines().filter(|line| ["a", "b"].contains(line)).count(), 2, "{}", back.out);
    assert!(run(folder.path(), &["diff", "one", "two", "--counts"], 0).out.contains("0 of 50 counts changed"));
    // One experiment does not compare with several, and folders without a common one do not compare.
    for (old, new, said) in
        [("one", "old", "records.csv"), ("old", "one", "records.csv"), ("one", "three", "in common")]
    {
        fs::create_dir_all(folder.path().join("three/d")).unwrap();
        fs::copy(folder.path().join("old/records.csv"), folder.path().join("three/d/records.csv")).unwrap();
        let refused = run(folder.path(), &["diff", old, new], 2);
        assert!(refused.err.contains(said), "{}", refused.err);
    }
    fs::create_dir(folder.path().join("empty")).unwrap();
    assert!(run(folder.path(), &["diff", "one", "empty"], 2).err.contains("nor an experiment"));
}

fn json_of(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

/// A name that would clear the screen, hide text or begin a line of the table is shown with its escapes.
#[test]
fn a_terminal_obeys_no_name() {
    let folder = in_memory();
    base(folder.path());
    let hostile = |from: &str, to: &str| {
        changed(folder.path(), from, to, |column, row| {
            let cell = &mut row[column("cell")];
            *cell = cell.replace("serial", "\u{1b}[2J\u{9b}31m\nserial");
            true
        });
    };
    hostile("old", "old-names");
    measured(folder.path(), "slow", |cell, repetition| 1.2 * steady(cell, repetition));
    hostile("slow", "slow-names");
    changed(folder.path(), "old-names", "gone", |column, row| !row[column("cell")].contains("serial"));
    let shown = "\\u{1b}[2J\\u{9b}31m\\nserial";
    for (arguments, code) in [
        (&["diff", "old-names", "slow-names"][..], 1),
        (&["diff", "old-names", "gone"], 1),
        (&["diff", "old-names", "gone", "--counts"], 1),
        (&["rank", "old-names"], 0),
    ] {
        let found = run(folder.path(), arguments, code);
        let all = found.out + &found.err;
        assert!(all.contains(shown), "{arguments:?}: {all}");
        assert!(!all.contains(|c: char| c.is_control() && c != '\n'), "{arguments:?}: {all:?}");
        assert!(!all.lines().any(|line| line.starts_with("serial")), "{arguments:?}: {all}");
    }
    let object = run(folder.path(), &["diff", "old-names", "slow-names", "--json"], 1);
    assert!(object.out.contains("\\u001b[2J\\u009b31m\\nserial"), "{}", object.out);
    json(&object);
}
