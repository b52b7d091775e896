//! The machine: what it is, in which condition it is, and where workers run on it.

use super::{json, record, run};
use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, pathmark};
use serde_json::Value;
use std::fs;

/// `machine` tells the same as the file beside rows, and the processors as the system counts them.
#[test]
fn the_machine_is_described_beside_rows() {
    let folder = tempfile::tempdir().unwrap();
    let told = run(folder.path(), &["machine"]).out;
    assert!(told.contains("processor") && told.contains("memory"), "{told}");
    let machine = json(&run(folder.path(), &["machine", "--json"]).out);
    write_tiny(folder.path(), TINY);
    run(folder.path(), &["run", "tiny.toml", "--filter", "strategy=serial", "--out", "out"]);
    let text = fs::read_to_string(folder.path().join("out/tiny/machine.toml")).unwrap();
    let file: toml::Table = text.parse().unwrap();
    let layout = serde_json::to_value(&file["machine"]["layout"]).unwrap();
    assert_eq!(layout, machine["layout"]);
    // Other systems do not tell which processors share a core.
    assert!(!layout["cores"].as_array().unwrap().is_empty() || !cfg!(target_os = "linux"));
}

/// `none` is the default, so its cells are those without the setting. Other systems cannot pin.
#[cfg(target_os = "linux")]
#[test]
fn pins_are_a_setting_of_experiments() {
    let folder = tempfile::tempdir().unwrap();
    let text = TINY
        .replace("threads = [1, 2]", "threads = [1]\npin = [\"none\", \"compact\"]")
        .replace("repetitions = 3", "repetitions = 1");
    write_tiny(folder.path(), &text);
    run(folder.path(), &["run", "tiny.toml", "--out", "out"]);
    let mut rows = csv::Reader::from_path(folder.path().join("out/tiny/records.csv")).unwrap();
    let heads = rows.headers().unwrap().clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let rows: Vec<csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    let count = |pin: &str| rows.iter().filter(|row| &row[column("pin")] == pin).count();
    assert_eq!((rows.len(), count(""), count("compact")), (6, 3, 3));
    for row in &rows {
        assert_eq!(row[column("cell")].contains("/pin-compact"), &row[column("pin")] == "compact", "{row:?}");
        assert_eq!(&row[column("error")], "", "{row:?}");
        // A pinned worker stays where it is.
        assert!(&row[column("pin")] != "compact" || &row[column("migrations")] == "0", "{row:?}");
    }
    let wrong = text.replace("compact", "60000");
    write_tiny(folder.path(), &wrong);
    let refused = finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "other"])).with_code(2);
    assert!(refused.err.contains("tiny.toml:") && refused.err.contains("processor 60000"), "{}", refused.err);
    assert!(!folder.path().join("other").exists());
}

/// A row has each counter, or says that the system does not grant it.
#[test]
fn counters_are_counted_or_missed() {
    let folder = tempfile::tempdir().unwrap();
    let row = record(folder.path(), "cornell", &["--counters"]);
    assert_eq!(row["counters"], Value::Bool(true));
    let warnings = row["warnings"].as_str().unwrap();
    for column in ["cycles", "instructions", "cache_misses", "branch_misses"] {
        assert!(row[column].is_u64() != warnings.contains(&column.replace('_', " ")), "{column}: {row}");
    }
    let without = record(folder.path(), "cornell", &[]);
    assert!(without["cycles"].is_null() && !without["warnings"].as_str().unwrap().contains("cycles"), "{without}");
    assert_eq!(without["checksum"], row["checksum"]);
}

#[test]
fn the_doctor_finds_the_noise() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(&run(folder.path(), &["doctor", "--seconds", "0.1", "--json"]).out);
    let names: Vec<&str> = found["facts"].as_array().unwrap().iter().filter_map(|fact| fact["name"].as_str()).collect();
    for name in ["governor", "turbo", "quota", "virtual machine", "clock source", "temperature", "steal"] {
        assert!(names.contains(&name), "{names:?}");
    }
    let noise = &found["noise"];
    assert!(
        noise["low"].as_f64() < noise["ratio"].as_f64() && noise["in_ten_minutes"]["half_width"].is_f64(),
        "{found}"
    );
    for seconds in ["0", "-1", "nan", "1e9"] {
        let refused = finish(pathmark(folder.path(), &["doctor", "--seconds", seconds])).with_code(2);
        assert!(refused.err.contains("seconds") && refused.err.contains("3600"), "{}", refused.err);
    }
    finish(pathmark(folder.path(), &["doctor", "--seconds", "soon"])).with_code(2);
}
