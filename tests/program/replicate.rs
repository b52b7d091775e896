//! `replicate`: do somebody's ratios, orders and images come out here, too?

use crate::experiment::write_tiny;
use crate::program::{finish, in_memory, pathmark};
use pathmark::measure::available_threads;
use serde_json::Value;
use std::collections::HashMap;
use std::fs;
use std::path::Path;

/// An experiment of two schedules in pairs.
const PAIRED: &str = r#"
title = "t"
question = "q"
figures = []

[[compare]]
with = { strategy = ["serial"] }

[matrix]
scene = ["cornell"]
estimator = ["bsdf"]
spp = [4]
seed = [1]
strategy = ["serial", "static-blocks"]
threads = [1]
decomposition = ["tiles:8x8"]

[quick]
size = [24, 16]
repetitions = 4
pairs = 2
"#;

/// Multiplies the seconds of a strategy in a file of rows, and returns the text.
fn bent(path: &Path, strategy: &str, factor: f64, noise: impl Fn(usize) -> f64) {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let heads = reader.headers().unwrap().clone();
    let at = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let (own, seconds) = (at("strategy"), at("makespan_s"));
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let mut writer = csv::Writer::from_path(path).unwrap();
    writer.write_record(&heads).unwrap();
    for (index, row) in rows.iter().enumerate() {
        let changed = row.iter().enumerate().map(|(column, field)| {
            let factor = if &row[own] == strategy { factor } else { 1.0 };
            if column == seconds { (0.01 * factor * noise(index)).to_string() } else { field.to_string() }
        });
        writer.write_record(changed).unwrap();
    }
    writer.flush().unwrap();
}

fn judged(folder: &Path, more: &[&str], code: i32) -> Vec<Value> {
    let all = [&["replicate", "theirs", "--out", "here", "--resume", "--json"], more].concat();
    serde_json::from_str(&finish(pathmark(folder, &all)).with_code(code).out).unwrap()
}

/// The verdicts on ratios and images; orders follow from the ratios.
fn verdicts(told: &[Value]) -> Vec<&str> {
    let told = told.iter().filter(|own| own["kind"] != "order");
    told.map(|own| own["verdict"]["is"].as_str().unwrap()).collect()
}

fn orders(told: &[Value]) -> Vec<(&str, f64, f64)> {
    let of = |own: &Value, key: &str| own[key].as_f64().unwrap();
    let told = told.iter().filter(|own| own["kind"] == "order");
    told.map(|own| (own["verdict"]["is"].as_str().unwrap(), of(own, "theirs"), of(own, "here"))).collect()
}

/// Rows with invented times: the same ratio is reproduced, one that is bent by 20 % is not, few noisy rows cannot tell; another
/// checksum is not reproduced.
#[test]
fn ratios_and_images_are_judged_and_seconds_are_not() {
    let folder = in_memory();
    write_tiny(folder.path(), PAIRED);
    finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "theirs"])).with_code(0);
    finish(pathmark(folder.path(), &["replicate", "theirs", "--out", "here", "--plan"])).with_code(0);
    assert!(!folder.path().join("here").exists());
    // Both ratios are of real times of some microseconds, so the first run may have any verdict.
    let first = pathmark(folder.path(), &["replicate", "theirs", "--out", "here", "--markdown"]);
    let out = finish(first);
    assert!(out.out.contains("# Replication of theirs"), "{} {}", out.out, out.err);
    let (theirs, here) = ("theirs/tiny/records.csv", "here/tiny/records.csv");
    let [theirs, here] = [theirs, here].map(|file| folder.path().join(file));
    let even = |index: usize| 1.0 + 0.001 * (index % 3) as f64;
    bent(&theirs, "static-blocks", 1.5, even);
    // Twice as slow in all, which is no statement.
    bent(&here, "static-blocks", 1.52, |index| 2.0 * even(index + 1));
    let told = judged(folder.path(), &[], 0);
    assert_eq!(verdicts(&told), ["reproduced", "reproduced"], "{told:?}");
    assert!((told[0]["theirs"].as_f64().unwrap() - 1.5).abs() < 0.01, "{told:?}");
    assert_eq!(orders(&told), [("reproduced", 1.0, 1.0)], "{told:?}");
    let page = fs::read_to_string(folder.path().join("here/report.html")).unwrap();
    assert!(page.contains("Replication of theirs") && page.contains("The machines side by side"), "{page}");
    // A ratio that differs is measured a second time: only there is it as theirs.
    let (first, second) = (folder.path().join("here/tiny"), folder.path().join("here/again/tiny"));
    let _ = fs::remove_dir_all(&second);
    fs::create_dir_all(&second).unwrap();
    for file in fs::read_dir(&first).unwrap().map(|file| file.unwrap().path()).filter(|file| file.is_file()) {
        fs::copy(&file, second.join(file.file_name().unwrap())).unwrap();
    }
    let again = second.join("records.csv");
    bent(&here, "static-blocks", 0.5, even);
    let told = judged(folder.path(), &[], 0);
    assert_eq!(verdicts(&told), ["cannot-tell", "reproduced"], "{told:?}");
    let note = told[0]["note"].as_str().unwrap();
    assert!(note.starts_with("a second measurement here does not show it (1.5"), "{told:?}");
    bent(&again, "static-blocks", 0.5, even);
    let told = judged(folder.path(), &[], 1);
    assert_eq!(verdicts(&told), ["not-reproduced", "reproduced"], "{told:?}");
    assert_eq!(orders(&told), [("not-reproduced", 1.0, 0.0)], "{told:?}");
    for rows in [&here, &again] {
        bent(rows, "static-blocks", 1.2 * 1.5, even);
    }
    assert_eq!(verdicts(&judged(folder.path(), &[], 1)), ["not-reproduced", "reproduced"]);
    assert_eq!(verdicts(&judged(folder.path(), &["--margin", "30%"], 0)), ["reproduced", "reproduced"]);
    bent(&here, "static-blocks", 1.5, |index| 1.0 + 0.3 * (index % 5) as f64);
    let told = judged(folder.path(), &[], 0);
    assert_eq!(verdicts(&told), ["cannot-tell", "reproduced"], "{told:?}");
    let text = fs::read_to_string(folder.path().join("here/REPLICATION.md")).unwrap();
    assert!(text.contains("| cannot tell | ") && text.contains("more repetition"), "{text}");
    let rows = fs::read_to_string(&theirs).unwrap();
    let mut reader = csv::Reader::from_path(&theirs).unwrap();
    let mut first: HashMap<String, String> = reader.deserialize().next().unwrap().unwrap();
    let checksum = first.remove("checksum").unwrap();
    fs::write(&theirs, rows.replace(&checksum, "sha256:0123456789abcdef")).unwrap();
    let told = finish(pathmark(folder.path(), &["replicate", "theirs", "--out", "here", "--resume"])).with_code(1);
    assert!(told.err.contains("1 statement not reproduced"), "{}", told.err);
    assert!(
        told.out.starts_with("not reproduced: tiny, image ") && told.out.contains("sha256:0123456789abcdef"),
        "{}",
        told.out
    );
}

/// Their machine has more processors: cells that use them are left out here, and named. A quick replication has at most four
/// repetitions of the others.
#[test]
fn cells_for_other_hardware_are_named() {
    let folder = in_memory();
    let (here, more) = (available_threads(), available_threads() + 1);
    let text = PAIRED.replace("threads = [1]", &format!("threads = [1, {more}]"));
    write_tiny(folder.path(), &text.replace("repetitions = 4", "repetitions = 5"));
    finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "theirs"])).with_code(0);
    let machine = folder.path().join("theirs/tiny/machine.toml");
    let text = fs::read_to_string(&machine).unwrap();
    let own = format!("\nprocessors = {here}\n");
    assert!(text.contains(&own), "{text}");
    fs::write(&machine, text.replace(&own, "\nprocessors = 1000\n")).unwrap();
    // Real times of some microseconds may have any verdict.
    let out = finish(pathmark(folder.path(), &["replicate", "theirs", "--quick", "--json"])).out;
    let told: Vec<Value> = serde_json::from_str(&out).unwrap();
    let why = format!("{more} processors instead of {here}");
    let elsewhere: Vec<&Value> = told.iter().filter(|own| own["verdict"]["why"] == why.as_str()).collect();
    assert!(elsewhere.iter().any(|own| own["kind"] == "ratio"), "{told:?}");
    assert!(told.iter().any(|own| own["kind"] == "image" && own["verdict"]["is"] == "reproduced"), "{told:?}");
    let rows = fs::File::open(folder.path().join("replication/tiny/records.csv")).unwrap();
    for row in csv::Reader::from_reader(rows).deserialize::<HashMap<String, String>>().map(Result::unwrap) {
        assert!(row["threads"] == "1" && row["repetition"].parse::<u32>().unwrap() < 4, "{row:?}");
    }
    let page = fs::read_to_string(folder.path().join("replication/report.html")).unwrap();
    assert!(page.contains(&format!("Other hardware: {why} (")) && page.contains(">1000</td>"), "{page}");
}

/// Where no statement could be judged, the exit code says so.
#[test]
fn rows_for_other_hardware_alone_are_no_success() {
    let folder = in_memory();
    let more = available_threads() + 1;
    write_tiny(folder.path(), &PAIRED.replace("threads = [1]", &format!("threads = [{more}]")));
    finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "theirs"])).with_code(0);
    let machine = folder.path().join("theirs/tiny/machine.toml");
    let text = fs::read_to_string(&machine).unwrap();
    let own = format!("\nprocessors = {}\n", available_threads());
    fs::write(&machine, text.replace(&own, "\nprocessors = 1000\n")).unwrap();
    let told = finish(pathmark(folder.path(), &["replicate", "theirs"])).with_code(1);
    assert!(told.err.contains("no statement could be judged"), "{}", told.err);
    assert!(
        told.out.contains("0 reproduced, 1 other hardware, 0 not measured, 0 cannot tell, 0 not reproduced"),
        "{}",
        told.out
    );
}

#[test]
fn wrong_folders_and_margins_are_refused() {
    let folder = in_memory();
    fs::create_dir(folder.path().join("empty")).unwrap();
    for (arguments, told) in [
        (&["replicate", "nowhere"][..], "nowhere"),
        (&["replicate", "empty"], "holds no experiment"),
        (&["replicate", "empty", "--margin", "0%"], "margin"),
        (&["replicate", "empty", "--margin", "wide"], "margin"),
    ] {
        let said = finish(pathmark(folder.path(), arguments)).with_code(2).err;
        assert!(said.contains(told), "{said}");
    }
}

/// Texts of the user's that begin like the program's own stay.
#[test]
fn notes_on_a_replication_are_not_overwritten() {
    let folder = in_memory();
    write_tiny(folder.path(), PAIRED);
    finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "theirs"])).with_code(0);
    let path = folder.path().join("here/REPLICATION.md");
    fs::create_dir(folder.path().join("here")).unwrap();
    for notes in ["# Replication notes\n\nMine.\n", "# Replication of theirs\n\nStatements of theirs: mine.\n"] {
        fs::write(&path, notes).unwrap();
        let said = finish(pathmark(folder.path(), &["replicate", "theirs", "--out", "here"])).with_code(2).err;
        assert!(said.contains("REPLICATION.md: already exists"), "{said}");
        assert_eq!(fs::read_to_string(&path).unwrap(), notes);
    }
}
