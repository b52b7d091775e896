//! A system that refuses to pin threads. A render ends with exit code 3 and writes no image. In an experiment, only the
//! pinned cells fail, and their rows give the reason.

use super::devices::make_library;
use crate::experiment::{TINY, write_tiny};
use crate::program::{Finished, finish, pathmark};
use crate::watchdog::Watchdog;
use pathmark::strategy::STRATEGIES;
use std::path::Path;
use std::time::Duration;

const REFUSED: &str = "pinning a thread to processor";

/// Runs `pathmark ARGUMENTS` where no thread may be pinned.
fn refused(folder: &Path, arguments: &[&str]) -> Finished {
    make_library(folder, "refusing-affinity.c", "refusing-affinity.so");
    let mut command = pathmark(folder, arguments);
    command.env("LD_PRELOAD", folder.join("refusing-affinity.so"));
    finish(command)
}

#[test]
fn renders_whose_pins_are_refused_end() {
    let watchdog = Watchdog::new(Duration::from_mins(5));
    let folder = tempfile::tempdir().unwrap();
    for name in STRATEGIES.iter().map(|entry| entry.name) {
        watchdog.now(name.to_string());
        let render = ["render", "cornell", "--size", "16x12", "--spp", "4", "--decomposition", "tiles:16x12"];
        let pinned = ["--threads", "1", "--strategy", name, "--pin", "compact", "-o", "none.pfm"];
        let finished = refused(folder.path(), &[&render[..], &pinned].concat()).with_code(3);
        assert!(finished.err.contains(REFUSED), "{name}: {}", finished.err);
        assert!(!folder.path().join("none.pfm").exists(), "{name}");
    }
}

#[test]
fn cells_whose_pins_are_refused_have_rows_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let pins = "threads = [1]\npin = [\"none\", \"compact\"]";
    write_tiny(folder.path(), &TINY.replace("threads = [1, 2]", pins).replace("repetitions = 3", "repetitions = 1"));
    refused(folder.path(), &["run", "tiny.toml", "--quick", "--out", "out"]).with_code(1);
    let mut rows = csv::Reader::from_path(folder.path().join("out/tiny/records.csv")).unwrap();
    let heads = rows.headers().unwrap().clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let rows: Vec<csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 6);
    for row in rows {
        let is_pinned = &row[column("pin")] == "compact";
        assert_eq!(row[column("error")].contains(REFUSED), is_pinned, "{row:?}");
        assert_eq!(row[column("checksum")].is_empty(), is_pinned, "{row:?}");
    }
}
