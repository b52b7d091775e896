//! `run --shard` and `merge`: one sweep from several machines.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, in_memory, pathmark};
use pathmark::measure::SCHEMA;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

fn run(folder: &Path, arguments: &[&str], code: i32) -> String {
    let finished = finish(pathmark(folder, arguments)).with_code(code);
    finished.out + &finished.err
}

/// The repetitions and the checksum of each cell.
fn rows(folder: &Path) -> BTreeMap<String, (BTreeSet<u32>, String)> {
    let mut reader = csv::Reader::from_path(folder.join("tiny/records.csv")).unwrap();
    let heads = reader.headers().unwrap().clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let (cell, repetition, checksum) = (column("cell"), column("repetition"), column("checksum"));
    let mut rows = BTreeMap::new();
    for row in reader.records() {
        let row = row.unwrap();
        let entry: &mut (BTreeSet<u32>, String) = rows.entry(row[cell].to_string()).or_default();
        assert!(entry.0.insert(row[repetition].parse().unwrap()), "twice: {row:?}");
        entry.1 = row[checksum].to_string();
    }
    rows
}

#[test]
fn parts_of_a_sweep_are_its_rows() {
    let folder = in_memory();
    write_tiny(folder.path(), TINY);
    run(folder.path(), &["run", "tiny.toml", "--out", "whole"], 0);
    let whole = rows(&folder.path().join("whole"));
    for shard in ["1/2", "2/2"] {
        run(folder.path(), &["run", "tiny.toml", "--shard", shard, "--out", &shard.replace('/', "-")], 0);
    }
    let said = run(folder.path(), &["merge", "2-2", "1-2", "-o", "merged"], 0);
    assert!(said.contains("report.html"), "{said}");
    let merged = rows(&folder.path().join("merged"));
    let cells = |rows: &BTreeMap<String, (BTreeSet<u32>, String)>| rows.keys().cloned().collect::<Vec<_>>();
    assert_eq!(cells(&merged), cells(&whole));
    for (cell, (repetitions, checksum)) in &merged {
        let (alone, expected) = &whole[cell];
        assert_eq!(checksum, expected, "{cell}");
        // A cell belongs to one part, a serial cell to each part that has a cell to compare with it.
        let parts: BTreeSet<u32> = repetitions.iter().map(|repetition| repetition % 2).collect();
        assert_eq!(repetitions.len(), alone.len() * parts.len(), "{cell}: {repetitions:?}");
        assert!(parts.len() == 1 || cell.contains("serial"), "{cell}: {repetitions:?}");
    }
    // A part can be resumed only as the same part.
    assert!(run(folder.path(), &["run", "tiny.toml", "--out", "1-2", "--resume"], 2).contains("shard"));
    assert!(run(folder.path(), &["merge", "2-2", "1-2", "-o", "merged"], 2).contains("merged"));
}

/// Serial cells of one image are baselines of each other; without other cells each belongs to one part only.
#[test]
fn parts_of_serial_cells_do_not_overlap() {
    let folder = in_memory();
    let serial = TINY
        .replace(r#"["serial", "static-blocks", "work-stealing"]"#, r#"["serial"]"#)
        .replace("threads = [1, 2]", "threads = [1]")
        .replace(r#"["tiles:8x8"]"#, r#"["tiles:8x8", "rows"]"#);
    write_tiny(folder.path(), &serial);
    for shard in ["1/2", "2/2"] {
        let out = shard.replace('/', "-");
        run(folder.path(), &["run", "tiny.toml", "--shard", shard, "--repetitions", "1", "--out", &out], 0);
    }
    let [first, second] = ["1-2", "2-2"].map(|out| rows(&folder.path().join(out)).into_keys().collect::<Vec<_>>());
    assert_eq!((first.len(), second.len()), (1, 1));
    assert_ne!(first, second);

    let merge = ["merge", "1-2", "2-2", "-o", "merged"];
    let refused = run(folder.path(), &[merge.as_slice(), &["--strict"]].concat(), 2);
    assert!(refused.contains("strict = true: ") && !folder.path().join("merged").exists(), "{refused}");
    let merged = finish(pathmark(folder.path(), &[merge.as_slice(), &["--json"]].concat())).with_code(0);
    let merged: serde_json::Value = serde_json::from_str(&merged.out).unwrap();
    assert_eq!((&merged["sweeps"][0]["rows"], &merged["reports"][0]), (&2.into(), &"merged/report.html".into()));
}

#[test]
fn parts_that_make_no_sweep_are_refused() {
    let folder = in_memory();
    write_tiny(folder.path(), TINY);
    for (shard, out) in [("1/3", "a"), ("2/3", "b"), ("1/2", "c")] {
        run(folder.path(), &["run", "tiny.toml", "--shard", shard, "--repetitions", "1", "--out", out], 0);
    }
    run(folder.path(), &["run", "tiny.toml", "--repetitions", "1", "--out", "whole"], 0);
    let refused = |parts: &[&str], said: &[&str]| {
        let text = run(folder.path(), &[&["merge"], parts, &["-o", "merged"]].concat(), 2);
        assert!(said.iter().all(|words| text.contains(words)), "{said:?} is not in {text}");
        assert!(!folder.path().join("merged").exists());
    };
    refused(&["a", "b"], &["3/3", "missing"]);
    refused(&["a", "c"], &["belong", "parts is"]);
    refused(&["a", "a"], &["1/3"]);
    refused(&["a", "whole"], &["whole", "no part"]);
    refused(&["a", "nowhere"], &["nowhere"]);
    assert!(run(folder.path(), &["merge", "a", "b", "-o", "merged", "--partial"], 0).contains("3/3"));
    // Rows of an edited experiment belong to another experiment.
    let edited = fs::read_to_string(folder.path().join("tiny.toml")).unwrap() + "\n# edited\n";
    fs::write(folder.path().join("tiny.toml"), edited).unwrap();
    run(folder.path(), &["run", "tiny.toml", "--shard", "3/3", "--repetitions", "1", "--out", "d"], 0);
    fs::remove_dir_all(folder.path().join("merged")).unwrap();
    refused(&["a", "b", "d"], &["belong", "definition"]);
    let text = run(folder.path(), &["run", "tiny.toml", "--shard", "1/99", "--out", "e"], 2);
    assert!(text.contains("at most"), "{text}");
}

/// Makes the two parts of a sweep in `a` and `b`, with one repetition.
fn two_parts(folder: &Path) {
    write_tiny(folder, TINY);
    for (shard, out) in [("1/2", "a"), ("2/2", "b")] {
        run(folder, &["run", "tiny.toml", "--shard", shard, "--repetitions", "1", "--out", out], 0);
    }
}

/// If the repetitions of any part had a goal, all intervals must allow for it. The limits of matrices hold for the merged
/// rows if they held for any part, and rows have a pair only if all parts gave them one.
#[test]
fn a_goal_of_one_part_is_a_goal_of_the_sweep() {
    let folder = in_memory();
    two_parts(folder.path());
    let described = |out: &str| folder.path().join(out).join("tiny/machine.toml");
    let [first, second] = ["a", "b"].map(|out| fs::read_to_string(described(out)).unwrap());
    let merged = |on_first: &str, on_second: &str, is_second_capped: bool| -> toml::Table {
        fs::write(described("a"), format!("{on_first}{first}")).unwrap();
        let second = if is_second_capped { second.replace("uncapped = true\n", "") } else { second.clone() };
        fs::write(described("b"), format!("{on_second}{second}")).unwrap();
        fs::remove_dir_all(folder.path().join("merged")).ok();
        run(folder.path(), &["merge", "a", "b", "-o", "merged"], 0);
        fs::read_to_string(described("merged")).unwrap().parse().unwrap()
    };
    let goal = |table: &toml::Table| table.get("until").map(|goal| goal.as_str().unwrap().to_string());
    assert_eq!(goal(&merged("", "", false)), None);
    assert_eq!(goal(&merged("", "until = \"3%\"\n", false)).as_deref(), Some("3%"));
    assert_eq!(goal(&merged("until = \"5%\"\n", "until = \"3%\"\n", false)).as_deref(), Some("3%, 5%"));
    assert_eq!(merged("", "", false).get("uncapped"), Some(&toml::Value::Boolean(true)));
    assert_eq!(merged("", "", true).get("uncapped"), None);
    // The key has its name in version 0.1, which is still read.
    let pair = |number: u32| format!("against = \"old\"\nsweep = \"{number}\"\n");
    let found = |table: &toml::Table| (table.contains_key("baseline"), table.get("sweep").map(ToString::to_string));
    let number = found(&merged(&pair(1), &pair(2), false));
    assert!(number.0 && number.1.is_some());
    assert_eq!(found(&merged(&pair(1), &pair(2), false)), number, "the same parts");
    assert_ne!(found(&merged(&pair(1), &pair(3), false)), number, "another part");
    assert_eq!(found(&merged(&pair(1), "", false)), (false, None));
}

/// A part without rows, or with fewer than its sweep has when it is finished, is missing.
#[test]
fn an_unfinished_part_of_a_sweep_is_missing() {
    let folder = in_memory();
    two_parts(folder.path());
    let records = folder.path().join("b/tiny/records.csv");
    let whole = fs::read_to_string(&records).unwrap();
    let rows = whole.lines().count() - 1;
    assert_eq!(rows, 3);
    for kept in [0, rows - 1] {
        let begun: Vec<&str> = whole.lines().take(1 + kept).collect();
        fs::write(&records, begun.join("\n") + "\n").unwrap();
        let text = run(folder.path(), &["merge", "a", "b", "-o", "merged"], 2);
        let told = format!("2/2: {kept} of at least {rows} rows in b");
        assert!(text.contains(&told) && !folder.path().join("merged").exists(), "{text}");
        assert!(run(folder.path(), &["merge", "a", "b", "-o", "merged", "--partial"], 0).contains(&told));
        fs::remove_dir_all(folder.path().join("merged")).unwrap();
    }
    // Older parts do not say how many rows they have; without any they are not finished.
    let described = folder.path().join("b/tiny/machine.toml");
    let text = fs::read_to_string(&described).unwrap();
    let older: Vec<&str> = text.lines().filter(|line| !line.starts_with("rows = ")).collect();
    fs::write(&described, older.join("\n")).unwrap();
    assert_eq!(older.len() + 1, text.lines().count());
    run(folder.path(), &["merge", "a", "b", "-o", "merged"], 0);
    fs::remove_dir_all(folder.path().join("merged")).unwrap();
    fs::write(&records, whole.lines().next().unwrap().to_string() + "\n").unwrap();
    assert!(run(folder.path(), &["merge", "a", "b", "-o", "merged"], 2).contains("0 of at least 1 rows"));
    fs::write(folder.path().join("a/tiny/records.csv"), "").unwrap();
    assert!(run(folder.path(), &["merge", "a", "b", "-o", "merged", "--partial"], 2).contains("no rows"));
    assert!(!folder.path().join("merged").exists());
}

type Damage = fn(&str) -> String;

/// After a refusal nothing is in the way of another attempt with mended parts.
#[test]
fn a_refused_merge_leaves_nothing() {
    let folder = in_memory();
    two_parts(folder.path());
    let damages: [(&str, Damage, &str); 4] = [
        ("b/tiny/records.csv", |text| text.replacen(&format!("\n{SCHEMA},"), "\nx,", 1), "records.csv:2:"),
        ("b/tiny/records.csv", |text| text[..text.len() - 5].to_string(), "half written"),
        ("a/tiny/experiment.toml", |text| text.replace("[matrix]", "[matr"), "experiment.toml"),
        ("b/tiny/records.csv", renumbered, "repetition = 4294967295"),
    ];
    for (file, damage, said) in damages {
        let path = folder.path().join(file);
        let whole = fs::read_to_string(&path).unwrap();
        let damaged = damage(&whole);
        assert_ne!(damaged, whole);
        fs::write(&path, damaged).unwrap();
        let text = run(folder.path(), &["merge", "a", "b", "-o", "merged"], 2);
        assert!(text.contains(said), "{said} is not in {text}");
        assert!(!folder.path().join("merged/tiny").exists(), "{said}");
        fs::write(&path, whole).unwrap();
    }
    run(folder.path(), &["merge", "a", "b", "-o", "merged"], 0);
}

/// Gives the first row the largest repetition, for which a merged sweep has no number.
fn renumbered(text: &str) -> String {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let heads = reader.headers().unwrap().clone();
    let at = heads.iter().position(|head| head == "repetition").unwrap();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&heads).unwrap();
    for (index, row) in reader.records().enumerate() {
        let row = row.unwrap();
        let fields =
            row.iter().enumerate().map(|(place, value)| if index == 0 && place == at { "4294967295" } else { value });
        writer.write_record(fields).unwrap();
    }
    String::from_utf8(writer.into_inner().unwrap()).unwrap()
}
