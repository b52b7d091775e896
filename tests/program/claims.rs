//! `pathmark claims`: verdicts from a folder of results.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, in_memory, pathmark};
use crate::snapshot::{assert_untouched, snapshot};
use pathmark::experiment::RunFile;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

/// The claims of all reports.
const CLAIMS: usize = 85;

/// A folder whose `out` has the rows of a small experiment under the name of a large one.
fn with_rows() -> tempfile::TempDir {
    let folder = in_memory();
    let rows = TINY.replace("tiles:8x8", "rows").replace("static-blocks", "thread-per-row");
    write_tiny(folder.path(), &rows);
    fs::rename(folder.path().join("tiny.toml"), folder.path().join("thread-scaling.toml")).unwrap();
    finish(pathmark(folder.path(), &["run", "thread-scaling.toml", "--out", "out"])).with_code(0);
    folder
}

fn listing(folder: &Path, more: &[&str]) -> Vec<serde_json::Value> {
    let arguments = [&["claims", "out", "--json"], more].concat();
    let told = finish(pathmark(folder, &arguments)).with_code(0).out;
    serde_json::from_str(&told).unwrap()
}

#[test]
fn small_images_do_not_judge_a_report_and_are_told_as_such() {
    let folder = with_rows();
    // The page of `run` shows the verdicts, but only `--out` writes them into files.
    let before = snapshot(folder.path());
    let verdicts = listing(folder.path(), &[]);
    assert_untouched(&before, &snapshot(folder.path()));
    assert!(!folder.path().join("out/CLAIMS.md").exists() && !folder.path().join("out/claims").exists());
    assert_eq!(listing(folder.path(), &["--out", "out"]), verdicts);
    assert_eq!(verdicts.len(), CLAIMS);
    let from_rows: Vec<&serde_json::Value> = verdicts.iter().filter(|row| row["source"].is_string()).collect();
    assert!(!from_rows.is_empty());
    for row in &from_rows {
        assert_eq!(row["source"], "out/thread-scaling/records.csv");
        let is_small = row["verdict"] == "not-comparable" && row["why"].as_str().unwrap().contains("of the pixels");
        assert!(is_small || row["verdict"] != "not-comparable", "{row}");
    }
    let text = fs::read_to_string(folder.path().join("out/CLAIMS.md")).unwrap();
    assert_eq!(text.matches("\n### ").count(), CLAIMS);
    let table = csv::Reader::from_path(folder.path().join("out/claims/claims.csv")).unwrap();
    assert_eq!(table.into_records().map(Result::unwrap).count(), CLAIMS);
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    let (claims, experiment) = (page.find("id=\"claims\"").unwrap(), page.find("id=\"thread-scaling\"").unwrap());
    assert!(experiment < claims, "the claims come last");
    // No verdict can be unexpected, because nothing was measured at the report's size.
    assert_eq!(listing(folder.path(), &["--strict"]).len(), CLAIMS);
}

#[test]
fn the_claims_of_one_report_are_printed_alone() {
    let folder = with_rows();
    let before = snapshot(folder.path());
    let verdicts = listing(folder.path(), &["--report", "A"]);
    assert!(verdicts.len() < CLAIMS && verdicts.iter().all(|row| row["report"] == "A"));
    assert_untouched(&before, &snapshot(folder.path()));
}

#[test]
fn folders_and_files_that_are_not_of_it_are_refused() {
    let folder = with_rows();
    fs::write(folder.path().join("out/CLAIMS.md"), "my own claims").unwrap();
    let before = snapshot(folder.path());
    for (arguments, told) in [
        (["claims", "out", "--report", "E"], "A, B, C, D"),
        (["claims", "nowhere", "--report", "A"], "nowhere"),
        (["claims", "out", "--out", "out"], "CLAIMS.md"),
    ] {
        let said = finish(pathmark(folder.path(), &arguments)).with_code(2).err;
        assert!(said.contains(told), "{said}");
    }
    assert_untouched(&before, &snapshot(folder.path()));
}

/// Verdicts of fewer rows do not replace those of more. Links lead from the folder of the verdicts to the rows.
#[test]
fn verdicts_are_not_replaced_by_fewer() {
    let folder = with_rows();
    fs::create_dir(folder.path().join("none")).unwrap();
    listing(folder.path(), &["--out", "verdicts"]);
    let text = fs::read_to_string(folder.path().join("verdicts/CLAIMS.md")).unwrap();
    assert!(text.contains("(../out/thread-scaling/records.csv)"), "{text}");
    let fewer = || finish(pathmark(folder.path(), &["claims", "none", "--out", "verdicts"]));
    let file = "verdicts/claims/claims.csv";
    let before = snapshot(folder.path());
    let refused = fewer().with_code(2);
    assert!(refused.err.contains(file) && refused.out.is_empty(), "{}", refused.err);
    assert_untouched(&before, &snapshot(folder.path()));
    fs::remove_file(folder.path().join(file)).unwrap();
    fewer().with_code(0);
    listing(folder.path(), &["--out", "verdicts"]);
}

/// The command of the README that compares results with ours ends in a sentence, and fails if an image has other bits.
#[test]
fn results_agree_with_earlier_ones_or_it_is_told_where_not() {
    let folder = with_rows();
    let readme = include_str!("../../README.md");
    let command = readme.lines().find(|line| line.starts_with("pathmark claims out --compare ")).unwrap();
    let words: Vec<&str> = command.split('#').next().unwrap().split_whitespace().skip(1).collect();
    let earlier = folder.path().join(words[3]);
    let copied = Command::new("cp").arg("-r").arg(folder.path().join("out")).arg(&earlier).status().unwrap();
    assert!(copied.success());
    let finding = "report = \"findings\"\ntitle = \"Ours\"\nabout = \"Numbers.\"\n[[claim]]\nid = 1\nclaim = \"a speedup\"\nlevel = 0.95\n\
        experiment = \"thread-scaling\"\nstatistic = \"speedup\"\nrows = { strategy = \"work-stealing\", threads = 2 }\n\
        over = { strategy = \"serial\" }\n";
    fs::write(earlier.join("findings.toml"), finding).unwrap();
    let before = snapshot(folder.path());
    let told = finish(pathmark(folder.path(), &words)).with_code(0).out;
    let last = told.lines().last().unwrap();
    assert!(last.contains("of 1 experiment agree with results in 1 of 1 images, bit for bit"), "{told}");
    assert!(last.contains("in 1 of 1 findings (1 with overlapping intervals, 0 on the same side of 1)"), "{told}");
    assert_untouched(&before, &snapshot(folder.path()));

    // Results with another image, and without the rows of the finding.
    let rows = earlier.join("thread-scaling/records.csv");
    let text = fs::read_to_string(&rows).unwrap();
    let checksum = csv::Reader::from_path(&rows).unwrap().into_deserialize::<BTreeMap<String, String>>().next();
    let checksum = checksum.unwrap().unwrap()["checksum"].clone();
    fs::write(&rows, text.replace(&checksum, &checksum.chars().rev().collect::<String>())).unwrap();
    let refused = finish(pathmark(folder.path(), &words)).with_code(1);
    assert!(refused.err.contains(&checksum) && refused.out.contains("in 0 of 1 images"), "{}", refused.out);
    fs::create_dir(folder.path().join("none")).unwrap();
    let told = finish(pathmark(folder.path(), &["claims", "none", "--compare", "results"])).with_code(0).out;
    assert!(told.contains("`pathmark reproduce --reports`, 1 finding and 0 verdicts more could be compared"), "{told}");
    let refused = finish(pathmark(folder.path(), &["claims", "out", "--compare", "nowhere"])).with_code(2);
    assert!(refused.err.contains("compare = nowhere"), "{}", refused.err);
}

/// The same rows are drawn to the same bytes, and `report` changes no file but the page and the figures.
#[test]
fn a_report_is_the_same_each_time() {
    let folder = with_rows();
    let report = || finish(pathmark(folder.path(), &["report", "out"])).with_code(0);
    let before = snapshot(folder.path());
    let pictures = before.keys().filter(|path| path.to_string_lossy().ends_with(".png")).count();
    assert!(pictures > 0);
    report();
    assert_untouched(&before, &snapshot(folder.path()));
}

/// A claim's bound that is younger than the rows which it judges, or rows without a time, fail `--strict`.
#[test]
fn strict_asks_for_bounds_that_are_older_than_their_rows() {
    let folder = in_memory();
    let cases = folder.path().join("out/check");
    fs::create_dir_all(&cases).unwrap();
    let head = "id,tries,pass,trials,failed,variant,expected,found,skipped";
    fs::write(cases.join("cases.csv"), format!("{head}\nP20,grid,true,1,0,v,1,1,\n")).unwrap();
    let strict = || pathmark(folder.path(), &["claims", "out", "--strict"]);
    let machine = |started: &str| {
        let run = RunFile { started_utc: started.to_string(), ..RunFile::of_now("pathmark selftest".to_string()) };
        run.write(&cases.join("machine.toml")).unwrap();
    };
    let refused = |why: &str| {
        let told = finish(strict()).with_code(1);
        assert!(told.err.contains("claims 43 have bounds that are not older"), "{why}: {}", told.err);
        assert!(told.out.contains(why), "{}", told.out);
    };
    refused("rows without a time");
    machine("2026-11-01T00:00:00Z");
    refused("bound younger than its rows");
    machine("9999-01-01T00:00:00Z");
    let told = finish(strict()).with_code(0).out;
    assert!(told.contains("bound older than its rows"), "{told}");
    // An unexpected verdict fails, too.
    fs::write(cases.join("cases.csv"), format!("{head}\nP20,grid,false,1,1,v,1,2,\n")).unwrap();
    assert!(finish(strict()).with_code(1).err.contains("claims 43 have unexpected verdicts"));
}

/// Two claims of one's own: a finding, whose number is that of the rows, and a prediction, which is judged.
#[test]
fn a_ledger_of_ones_own_is_measured_and_judged() {
    let folder = with_rows();
    let finding = "id = 1\nclaim = \"Samples.\"\nexperiment = \"thread-scaling\"\nstatistic = \"value\"\ncolumn = \"spp\"\nlevel = 0.95\n";
    let predicted = finding.replace("id = 1", "id = 2")
        + "within = [1000, 2000]\nreason = \"r\"\nquote = \"q\"\nplace = \"p\"\nreported = \"n\"\nexpected = \"refuted\"\nfrozen = \"2000-01-01T00:00:00Z\"\n";
    let ledger = format!(
        "report = \"own\"\ntitle = \"My numbers\"\nabout = \"About.\"\n[[claim]]\n{finding}[[claim]]\n{predicted}"
    );
    fs::write(folder.path().join("mine.toml"), &ledger).unwrap();
    let verdicts = listing(folder.path(), &["--ledger", "mine.toml", "--out", "out", "--strict"]);
    let told = |key: &str| verdicts.iter().map(|row| row[key].as_str().unwrap()).collect::<Vec<_>>();
    assert_eq!(told("verdict"), ["measured", "refuted"]);
    assert_eq!(told("measured"), ["4", "4"]);
    for row in &verdicts {
        let numbers = ["value", "low", "high", "level"].map(|key| row[key].as_f64().unwrap());
        assert_eq!(numbers, [4.0, 4.0, 4.0, 1.0], "{row}");
    }
    assert_eq!((told("quote"), told("place")), (vec!["", "q"], vec!["", "p"]));
    assert_eq!(told("frozen"), ["", "2000-01-01T00:00:00Z"]);
    let text = fs::read_to_string(folder.path().join("out/MINE.md")).unwrap();
    assert!(text.starts_with("# My numbers\n") && text.contains("\n| Samples. | 4 |"), "{text}");
    let table = fs::read_to_string(folder.path().join("out/claims/mine.csv")).unwrap();
    assert!(table.contains("\n1,own,measured,"), "{table}");
    // A file of the same name that is not such a list stays, and so does a wrong ledger's place of the fault.
    fs::write(folder.path().join("out/MINE.md"), "# My numbers\n\nNotes.\n").unwrap();
    let refused = ["claims", "out", "--ledger", "mine.toml", "--out", "out"];
    assert!(finish(pathmark(folder.path(), &refused)).with_code(2).err.contains("MINE.md"));
    fs::write(folder.path().join("mine.toml"), ledger.replace("quote = \"q\"\n", "")).unwrap();
    let error = finish(pathmark(folder.path(), &["claims", "out", "--ledger", "mine.toml"])).with_code(2).err;
    assert!(error.contains("mine.toml:12:") && error.contains("`quote`"), "{error}");
}
