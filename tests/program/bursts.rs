//! `pathmark bursts`: rows of all turns, ratios over processes, refusals. No test looks at a time.

use crate::program::{finish, pathmark};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;

const SMALL: [&str; 7] = ["bursts", "--regions", "2", "--jobs", "4", "--threads", "2"];

#[test]
fn pools_take_turns_in_every_process() {
    let folder = tempfile::tempdir().unwrap();
    let own = ["--strategy", "fixed-pool,rayon,shared-counter", "--gap", "1us,0s", "--rounds", "2", "--processes", "3"];
    let all = [&SMALL[..], &own, &["--out", "new", "--json"]].concat();
    let said = finish(pathmark(folder.path(), &all)).with_code(0).out;
    let lines: Vec<Value> = serde_json::from_str(&said).unwrap();
    let of = |name: &str| lines.iter().map(|line| line[name].clone()).collect::<Vec<Value>>();
    assert_eq!(of("strategy"), ["fixed-pool", "rayon", "shared-counter", "fixed-pool", "rayon", "shared-counter"]);
    assert_eq!(of("started"), [0.0, 0.0, 2.0, 0.0, 0.0, 2.0]);
    // The yardstick has no ratio to itself, and without gaps nobody idles in them.
    assert_eq!(
        of("wake_ratio").iter().map(Value::is_null).collect::<Vec<_>>(),
        [false, true, false, false, true, false]
    );
    assert_eq!(of("idle_processors").iter().filter(|idle| idle.is_null()).count(), 3);

    let mut reader = csv::Reader::from_path(folder.path().join("new/bursts.csv")).unwrap();
    let rows: Vec<Vec<String>> =
        reader.records().map(|row| row.unwrap().iter().map(str::to_string).collect()).collect();
    assert_eq!(rows.len(), 3 * 2 * 2 * 3);
    // The first in a round was the last in the round before.
    let first: Vec<&str> = rows.iter().filter(|row| row[2] == "0").map(|row| row[3].as_str()).collect();
    assert_eq!(first.iter().copied().collect::<BTreeSet<_>>(), BTreeSet::from(["fixed-pool", "shared-counter"]));
    assert!(fs::read_to_string(folder.path().join("new/machine.toml")).unwrap().contains("bursts --regions 2"));
    // Measurements are not overwritten.
    let again = finish(pathmark(folder.path(), &all)).with_code(2).err;
    assert!(again.contains("new/bursts.csv") && again.contains("overwritten"), "{again}");

    let table = finish(pathmark(folder.path(), &[&SMALL[..], &["--gap", "1us", "--processes", "1"]].concat()));
    let table = table.with_code(0);
    assert!(table.out.contains("chili") && !table.out.contains("serial") && !table.out.contains("static-blocks"));
    assert!(table.out.contains("beyond the noise") && table.err.contains("3 processes"), "{}", table.err);
}

/// `reproduce` writes the same two files into the same folder.
#[test]
fn the_page_of_a_folder_shows_its_bursts() {
    let folder = tempfile::tempdir().unwrap();
    let own = ["--strategy", "fixed-pool,rayon", "--gap", "1us", "--rounds", "1", "--processes", "2"];
    finish(pathmark(folder.path(), &[&SMALL[..], &own, &["--out", "out/bursts"]].concat())).with_code(0);
    finish(pathmark(folder.path(), &["report", "out"])).with_code(0);
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    for part in ["Does spinning pay?", "id=\"bursts-wakes\"", "fewer than 3 processes", "|fixed-pool\""] {
        assert!(page.contains(part), "{part}");
    }
    assert!(folder.path().join("out/bursts/figures/wakes.png").is_file());
}

#[test]
fn wrong_input_is_refused_before_any_turn() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&[&str], &str); 5] = [
        (&["--strategy", "none-such"], "strategy = none-such"),
        (&["--strategy", "rayon", "--with", "chili"], "allowed: rayon"),
        (&["--gap", "fast"], "--gap"),
        (&["--job", "1h"], "from 0s to 1s"),
        (&["--regions", "0"], "--regions"),
    ];
    for (own, said) in cases {
        let err = finish(pathmark(folder.path(), &[&["bursts", "--out", "new"], own].concat())).with_code(2).err;
        assert!(err.contains(said), "{own:?}: {err}");
        assert!(!folder.path().join("new").exists(), "{own:?}");
    }
}
