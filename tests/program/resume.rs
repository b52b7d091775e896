//! A resumed sweep gives the rows of an undisturbed one: each row once, whole, with the same checksums.
//! `tests/program/faults` has the kills at any instant and the torn rows.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, in_memory, pathmark};
use crate::snapshot::{assert_untouched, snapshot};
use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

const RUN: [&str; 4] = ["run", "tiny.toml", "--out", "out"];
const RESUME: [&str; 5] = ["run", "tiny.toml", "--out", "out", "--resume"];

/// A folder with `tiny.toml`, and the path of the rows to come.
fn prepared(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = in_memory();
    write_tiny(folder.path(), text);
    let records = folder.path().join("out/tiny/records.csv");
    (folder, records)
}

/// One map from column to value for each row; the reader requires that every row has all columns.
fn rows(records: &Path) -> Vec<BTreeMap<String, String>> {
    csv::Reader::from_path(records).unwrap().deserialize().map(|row| row.expect("no row is torn")).collect()
}

/// (cell, repetition), and the values that must not depend on the time of the run.
fn results(records: &Path) -> BTreeMap<(String, String), [String; 3]> {
    let rows = rows(records);
    let key = |row: &BTreeMap<String, String>| (row["cell"].clone(), row["repetition"].clone());
    let value = |row: &BTreeMap<String, String>| ["checksum", "rays", "error"].map(|column| row[column].clone());
    let results: BTreeMap<_, _> = rows.iter().map(|row| (key(row), value(row))).collect();
    assert_eq!(results.len(), rows.len(), "a row is doubled");
    results
}

/// Replaces fields of the rows: `field` gets the number of a row, the name of a column and the old text.
fn rewrite(records: &Path, field: impl for<'a> Fn(usize, &str, &'a str) -> &'a str) {
    let mut reader = csv::Reader::from_path(records).unwrap();
    let headers = reader.headers().unwrap().clone();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&headers).unwrap();
    for (index, row) in reader.records().enumerate() {
        let row = row.unwrap();
        writer.write_record(headers.iter().zip(&row).map(|(column, own)| field(index, column, own))).unwrap();
    }
    fs::write(records, writer.into_inner().unwrap()).unwrap();
}

/// Killed between the creation of the folder's files: `--resume` continues from any of these states.
#[test]
fn a_sweep_killed_before_its_first_row_can_be_resumed() {
    let (folder, records) = prepared(TINY);
    finish(pathmark(folder.path(), &RUN)).with_code(0);
    let expected = results(&records);
    let machine = fs::read(records.with_file_name("machine.toml")).unwrap();
    for has_machine in [true, false] {
        println!("machine.toml: {has_machine}");
        fs::remove_dir_all(folder.path().join("out")).unwrap();
        fs::create_dir_all(records.parent().unwrap()).unwrap();
        fs::write(&records, "").unwrap();
        if has_machine {
            fs::write(records.with_file_name("machine.toml"), &machine).unwrap();
        }
        finish(pathmark(folder.path(), &RESUME)).with_code(0);
        assert_eq!(results(&records), expected);
    }
}

/// The time limit once was a column behind the settings: rows in that order go on in today's, and no value changes its
/// column.
#[test]
fn columns_in_another_order_are_put_in_order() {
    let (folder, records) = prepared(TINY);
    finish(pathmark(folder.path(), &RUN)).with_code(0);
    let (expected, whole) = (results(&records), fs::read(&records).unwrap());
    let mut reader = csv::Reader::from_path(&records).unwrap();
    let heads = reader.headers().unwrap().clone();
    let place = |name: &str| heads.iter().position(|own| own == name).unwrap();
    let (from, to) = (place("time_limit_s"), place("target_error"));
    assert!(from < to);
    let moved = |row: &csv::StringRecord| {
        let mut fields: Vec<String> = row.iter().map(str::to_string).collect();
        fields[from..=to].rotate_left(1);
        fields
    };
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(moved(&heads)).unwrap();
    reader.records().for_each(|row| writer.write_record(moved(&row.unwrap())).unwrap());
    let old = writer.into_inner().unwrap();
    fs::write(&records, &old).unwrap();
    finish(pathmark(folder.path(), &RESUME)).with_code(0);
    assert_eq!(fs::read(&records).unwrap(), whole);
    // Without its last row, which is run again.
    let end = old[..old.len() - 1].iter().rposition(|byte| *byte == b'\n').unwrap() + 1;
    fs::write(&records, &old[..end]).unwrap();
    finish(pathmark(folder.path(), &RESUME)).with_code(0);
    assert_eq!(results(&records), expected);
}

/// A failed row is no result: it is run again, and appears once.
#[test]
fn a_failed_row_is_run_again() {
    let (folder, records) = prepared(TINY);
    finish(pathmark(folder.path(), &RUN)).with_code(0);
    let expected = results(&records);
    rewrite(&records, |index, column, field| if (index, column) == (4, "error") { "killed" } else { field });

    finish(pathmark(folder.path(), &RESUME)).with_code(0);
    assert_eq!(results(&records), expected);
    let rows = rows(&records);
    let orders: HashSet<&str> = rows.iter().map(|row| row["run_order"].as_str()).collect();
    assert_eq!(orders.len(), rows.len(), "two rows claim the same position in the sweep");
}

#[test]
fn resuming_a_finished_sweep_changes_no_row() {
    let (folder, records) = prepared(TINY);
    finish(pathmark(folder.path(), &RUN)).with_code(0);
    let before = fs::read(&records).unwrap();
    finish(pathmark(folder.path(), &RESUME)).with_code(0);
    assert_eq!(fs::read(&records).unwrap(), before);
    // More repetitions are appended to the old rows.
    finish(pathmark(folder.path(), &[RESUME.as_slice(), &["--repetitions", "4"]].concat())).with_code(0);
    assert!(fs::read(&records).unwrap().starts_with(&before));
    assert_eq!(results(&records).len(), 5 * 4);
}

/// Rows of another definition, profile, processor or revision are not repetitions of these rows.
#[test]
fn resuming_with_another_definition_or_machine_is_refused() {
    let (folder, records) = prepared(TINY);
    finish(pathmark(folder.path(), &RUN)).with_code(0);
    let refused = |arguments: &[&str], said: &str| {
        let before = snapshot(folder.path());
        let finished = finish(pathmark(folder.path(), arguments)).with_code(2);
        assert!(finished.err.contains("machine.toml") && finished.err.contains(said), "{said}: {}", finished.err);
        assert_eq!(finished.out, "");
        assert_untouched(&before, &snapshot(folder.path()));
    };
    refused(&[RESUME.as_slice(), &["--full"]].concat(), "profile = quick");
    write_tiny(folder.path(), &TINY.replace("seed = [1]", "seed = [2]"));
    refused(&RESUME, "is not the one that these rows were measured with");
    write_tiny(folder.path(), TINY);

    let machine = records.with_file_name("machine.toml");
    let text = fs::read_to_string(&machine).unwrap();
    for field in ["cpu", "commit"] {
        let line = text.lines().find(|line| line.starts_with(&format!("{field} = "))).unwrap();
        fs::write(&machine, text.replace(line, &format!("{field} = \"another\""))).unwrap();
        refused(&RESUME, &format!("{field} = another"));
    }
}

/// A curve gives a row at 4, 8, 16, 32 and 40 samples, each with the checksum of an image rendered at once: the second
/// matrix has those on another schedule. Cut off among its rows and resumed, the curve has each row once.
#[test]
fn a_curve_cut_off_among_its_rows_is_resumed() {
    let curve = TINY
        .replace("spp = [4]", "spp = [40]\ncurve = true")
        .replace("[\"serial\", \"static-blocks\", \"work-stealing\"]", "[\"serial\"]");
    let (head, scales) = curve.split_once("[quick]").unwrap();
    let (head, matrix) = head.split_once("[matrix]").unwrap();
    // On another schedule, because only one of equal cells is kept.
    let single = matrix.replace("spp = [40]\ncurve = true", "spp = [4, 8, 16, 32, 40]");
    let single = single.replace("[\"serial\"]", "[\"static-blocks\"]").replace("[1, 2]", "[1]");
    let text = format!("{head}[[matrix]]{matrix}[[matrix]]{single}[quick]{scales}");
    let (folder, records) = prepared(&text);
    finish(pathmark(folder.path(), &RUN)).with_code(0);
    let expected = results(&records);
    assert_eq!(expected.len(), (5 + 5) * 3);
    let spp: Vec<u32> = rows(&records)
        .iter()
        .filter(|row| row["cell"].ends_with("curve-40") && row["repetition"] == "0")
        .map(|row| row["spp"].parse().unwrap())
        .collect();
    assert_eq!(spp, [4, 8, 16, 32, 40]);
    let seconds: Vec<f64> = rows(&records)
        .iter()
        .filter(|row| row["cell"].ends_with("curve-40") && row["repetition"] == "1" && row["spp"] != "4")
        .map(|row| row["makespan_s"].parse().unwrap())
        .collect();
    assert!(seconds[1] < seconds[2] && seconds[2] < seconds[3], "cumulative: {seconds:?}");

    let whole = fs::read_to_string(&records).unwrap();
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    let inside = lines.windows(2).position(|pair| pair.iter().all(|line| line.contains("curve-40"))).unwrap() + 1;
    fs::write(&records, lines[..inside].concat()).unwrap();
    finish(pathmark(folder.path(), &RESUME)).with_code(0);
    assert_eq!(results(&records), expected);
}
