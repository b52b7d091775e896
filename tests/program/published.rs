//! The committed tables of figures are those that `pathmark report` makes of the rows beside them.

use crate::faults::is_thorough;
use crate::program::{finish, in_memory, pathmark};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folders of results whose tables are made again; a thorough test takes all of them.
const FEW: [&str; 3] = ["results/effects-in-lanes", "results/full", "results/many-cores"];
const MORE: [&str; 3] = ["results", "results/reports", "results/xeon"];

/// Tables that also take images, references or traces, which are too large to be committed.
const NOT_FROM_ROWS: [&str; 10] = [
    "balance.csv",
    "effect-steps.csv",
    "forecast.csv",
    "gallery.csv",
    "losses.csv",
    "precision.csv",
    "predictions.csv",
    "rank-predictions.csv",
    "ranks-forecast.csv",
    "scene-accuracy-table.csv",
];

fn tables(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(tables(&path));
        } else if path.extension().is_some_and(|end| end == "csv") && folder.ends_with("figures") {
            found.push(path);
        }
    }
    found
}

/// Whether two fields say the same. Other machines' functions may give another last digit.
fn is_same(old: &str, new: &str) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
    old == new || matches!((old.parse(), new.parse()), (Ok(a), Ok(b)) if near(a, b))
}

fn fields(path: &Path) -> Vec<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_path(path).unwrap();
    reader.records().map(|row| row.unwrap().iter().map(str::to_string).collect()).collect()
}

#[test]
fn committed_tables_are_what_their_rows_give() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = in_memory();
    assert!(Command::new("cp").arg("-r").arg(root.join("results")).arg(folder.path()).status().unwrap().success());
    let parts: Vec<&str> = FEW.into_iter().chain(MORE.into_iter().filter(|_| is_thorough())).collect();
    let made = tables(&folder.path().join("results"));
    let made: Vec<&PathBuf> =
        made.iter().filter(|table| parts.iter().any(|part| table.starts_with(folder.path().join(part)))).collect();
    for table in &made {
        fs::remove_file(table).unwrap();
    }
    for part in parts {
        finish(pathmark(folder.path(), &["report", part])).with_code(0);
    }
    for table in &made {
        let name = table.strip_prefix(folder.path()).unwrap();
        if NOT_FROM_ROWS.iter().any(|end| name.ends_with(end)) {
            continue;
        }
        let (old, new) = (fields(&root.join(name)), fields(table));
        assert_eq!(old.len(), new.len(), "{}", name.display());
        for (old, new) in old.iter().zip(&new) {
            let is_same = old.len() == new.len() && old.iter().zip(new).all(|(old, new)| is_same(old, new));
            assert!(is_same, "{}: {old:?}, now {new:?}", name.display());
        }
    }
    assert!(made.len() > 20, "{} tables", made.len());
}
