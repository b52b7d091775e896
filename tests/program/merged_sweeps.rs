//! `run --shard` and `merge`: one sweep from several machines.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, pathmark};
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
    let folder = tempfile::tempdir().unwrap();
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
    let folder = tempfile::tempdir().unwrap();
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
    let folder = tempfile::tempdir().unwrap();
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
