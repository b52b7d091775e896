//! F01: a sweep that a signal ends at any instant resumes to the rows and images of an undisturbed sweep.

use super::kills::{End, Killer, endings, leftovers};
use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, pathmark};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::Instant;

const RESUME: [&str; 5] = ["run", "tiny.toml", "--out", "out", "--resume"];
/// Five cells, three repetitions.
const ROWS: usize = 15;

/// The definition of a sweep that renders references first and keeps images.
pub(crate) fn text() -> String {
    let text = TINY.replace("[quick]\n", "[reference]\nestimator = \"bsdf\"\n\n[quick]\nreference-spp = 400\n");
    text.replace("[matrix]", "keep = [\"images\"]\n\n[matrix]")
}

/// Whether a column depends on the run alone, not on the machine or its times.
fn is_fixed(column: &str) -> bool {
    let measured = ["warnings", "started_utc", "workers_used", "peak_rss_bytes", "migrations"];
    !(["_s", "_switches", "_mhz"].iter().any(|unit| column.ends_with(unit)) || measured.contains(&column))
}

/// The finished rows in their order, without measured columns.
pub(crate) fn rows(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let text = fs::read(folder.join("out/tiny/records.csv")).unwrap_or_default();
    let end = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
    let rows = csv::Reader::from_reader(&text[..end]).into_deserialize::<BTreeMap<String, String>>();
    let fixed = |row: BTreeMap<String, String>| row.into_iter().filter(|(column, _)| is_fixed(column)).collect();
    rows.map(|row| fixed(row.expect("no row is torn"))).collect()
}

/// The contents of images and references by file name.
pub(crate) fn pictures(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for kind in ["out/tiny/images", "out/references"] {
        for entry in fs::read_dir(folder.join(kind)).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            if !name.starts_with('.') {
                found.insert(name, fs::read(path).unwrap());
            }
        }
    }
    found
}

#[test]
fn a_sweep_killed_at_any_instant_is_resumed_to_the_same_rows() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_tiny(folder, &text());
    let start = Instant::now();
    finish(pathmark(folder, &RESUME)).with_code(0);
    let whole = start.elapsed();
    let (expected, expected_pictures) = (rows(folder), pictures(folder));
    assert_eq!((expected.len(), expected_pictures.len()), (ROWS, 1 + 2));
    assert!(expected.iter().all(|row| row["error"].is_empty()));
    let mut killer = Killer::new(folder, whole);
    let (mut torn, mut resumed) = (0, 0);
    for ending in endings() {
        let (mut kills, mut sweeps) = (0, 0);
        // Kills come at random instants, so the loop continues until one has left rows to resume from.
        while kills < Killer::kills() || resumed == 0 {
            fs::remove_dir_all(folder.join("out")).unwrap();
            let mut before = 0;
            loop {
                let end = killer.run(pathmark(folder, &RESUME), ending, before == 0);
                let found = rows(folder);
                // Each row has its place in the undisturbed sweep, and no row is doubled or lost.
                assert!(found.len() >= before, "{ending:?}: {} rows after {before}", found.len());
                let wrong = found.iter().zip(&expected).position(|(found, expected)| found != expected);
                assert!(wrong.is_none() && found.len() <= ROWS, "{ending:?}: {} rows, {wrong:?} is wrong", found.len());
                before = found.len();
                if end == End::Finished {
                    break;
                }
                kills += 1;
                resumed += usize::from(before > 0);
                let text = fs::read(folder.join("out/tiny/records.csv")).unwrap_or_default();
                torn += usize::from(text.last().is_some_and(|byte| *byte != b'\n'));
            }
            assert_eq!(before, ROWS);
            assert!(pictures(folder) == expected_pictures, "{ending:?}: another image after {kills} kills");
            sweeps += 1;
        }
        println!("{ending:?}: {kills} kills, {sweeps} sweeps to their end");
    }
    println!("{resumed} kills left rows to go on from");
    println!("whole sweep {whole:?}, {torn} rows torn");
    finish(pathmark(folder, &RESUME)).with_code(0);
    for kept in ["out", "out/tiny", "out/tiny/images", "out/references"] {
        assert_eq!(leftovers(&folder.join(kept)), 0, "unfinished files that kills left in {kept}");
    }
}
