//! Experiments with a time limit: each row is the image of the samples that it reached.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, in_memory, pathmark};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

type Row = BTreeMap<String, String>;

const RUN: [&str; 4] = ["run", "tiny.toml", "--out", "out"];

fn limited() -> String {
    let text = TINY
        .replace("[\"speedup\", \"schedules\"]", "[\"equal-time\"]\nkeep = [\"images\"]")
        .replace("[\"smallpt\"]", "[\"bsdf\", \"mis\"]\ntime-limit = [0.01]")
        .replace("[4]", "[65536]")
        .replace("[1]", "[1, 2]")
        .replace("[\"serial\", \"static-blocks\", \"work-stealing\"]", "[\"serial\"]")
        .replace("threads = [1, 2]", "threads = [1]");
    let text = text.replace("repetitions = 3", "repetitions = 2\nreference-spp = 64");
    format!("{text}\n[reference]\nestimator = \"mis\"\n")
}

fn rows(folder: &Path, out: &str) -> Vec<Row> {
    let path = folder.join(out).join("tiny/records.csv");
    csv::Reader::from_path(path).unwrap().into_deserialize().collect::<csv::Result<_>>().unwrap()
}

/// A render with the samples of a row, from the start and without a limit, has its checksum.
#[test]
fn rows_with_a_time_limit_are_images_of_the_samples_that_they_reached() {
    let folder = in_memory();
    write_tiny(folder.path(), &limited());
    finish(pathmark(folder.path(), &RUN)).with_code(0);
    finish(pathmark(folder.path(), &[&RUN[..], &["--resume", "--repetitions", "3"]].concat())).with_code(0);
    let rows = rows(folder.path(), "out");
    assert_eq!(rows.len(), 2 * 2 * 3);
    for row in &rows {
        assert_eq!((row["time_limit_s"].as_str(), row["error"].as_str()), ("0.01", ""), "{row:?}");
        assert!((1..65536).contains(&row["spp"].parse::<u32>().unwrap()) && !row["rmse_display"].is_empty(), "{row:?}");
        let image = ["render", "cornell", "--size", "24x16", "--json", "-o", "again.pfm"];
        let of_row = ["--estimator", &row["estimator"], "--seed", &row["seed"], "--spp", &row["spp"]];
        let again = finish(pathmark(folder.path(), &[&image[..], &of_row[..]].concat())).with_code(0);
        let again: serde_json::Value = serde_json::from_str(&again.out).unwrap();
        assert_eq!(again["checksum"], row["checksum"].as_str(), "{row:?}");
    }
    let figures = folder.path().join("out/tiny/figures");
    assert!(figures.join("equal-time.png").is_file());
    let table = fs::read_to_string(figures.join("equal-time.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 2, "{table}");
    let report = ["report", "out", "--crops", "2,3,8", "--crops", "16,0,4", "--paper", "paper.tex"];
    let written = finish(pathmark(folder.path(), &report)).with_code(0);
    let lines: Vec<&str> = written.out.lines().collect();
    assert_eq!(lines, ["out/report.html", "out/tiny/figures/crops.png", "paper.tex"]);
    let paper = fs::read_to_string(folder.path().join("paper.tex")).unwrap();
    for word in paper.split('\\').filter(|word| word.starts_with("results/")) {
        let stem = word.trim_end().trim_end_matches('}');
        let figure = format!("{}.png", stem.replacen("results", "out", 1));
        assert!(folder.path().join(&figure).is_file(), "{figure}");
    }
    assert!(paper.contains("/figures/equal-time}") && paper.contains("\\newcommand{\\results}{out}"), "{paper}");
    fs::write(folder.path().join("paper.tex"), "edited").unwrap();
    for (refused, said) in [(["--paper", "paper.tex"], "already exists"), (["--crops", "20,0,8"], "24x16")] {
        let finished = finish(pathmark(folder.path(), &[&["report", "out"], &refused[..]].concat())).with_code(2);
        assert!(finished.err.contains(said), "{}", finished.err);
    }
    assert_eq!(fs::read_to_string(folder.path().join("paper.tex")).unwrap(), "edited");
}

#[test]
fn another_time_limit_is_set_and_selected_by_the_command() {
    let folder = in_memory();
    write_tiny(folder.path(), &limited());
    let options = ["--set", "time-limit=0.002,0.004", "--filter", "time-limit=0.004", "--repetitions", "1"];
    finish(pathmark(folder.path(), &[&RUN[..], &options].concat())).with_code(0);
    let rows = rows(folder.path(), "out");
    assert!(rows.len() == 4 && rows.iter().all(|row| row["time_limit_s"] == "0.004"), "{rows:?}");
    let refused = [&RUN[..], &["--set", "time-limit=soon"]].concat();
    let finished = finish(pathmark(folder.path(), &refused)).with_code(2);
    assert!(finished.err.contains("time-limit") && finished.err.contains("soon"), "{}", finished.err);
}
