//! `--cache FOLDER`: the tree over a large scene is built once, for all later commands and images.

use crate::experiment::{TINY, write_tiny};
use crate::program::{Finished, finish, pathmark};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

fn render(folder: &Path, more: &[&str]) -> Finished {
    let base = ["render", "spheres:5000", "--size", "16x12", "--spp", "1", "--cache", "trees", "--json", "-o", "x.pfm"];
    finish(pathmark(folder, &[&base, more].concat()))
}

fn record(finished: &Finished) -> Value {
    serde_json::from_str(&finished.out).unwrap()
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort_unstable();
    files
}

#[test]
fn a_tree_is_built_once_and_the_image_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let without = ["render", "spheres:5000", "--size", "16x12", "--spp", "1", "--json", "-o", "x.pfm"];
    let without = record(&finish(pathmark(folder.path(), &without)).with_code(0));
    assert!(without["build_s"].as_f64().unwrap() > 0.0);
    let trees = folder.path().join("trees");
    let mut kept = None;
    // Equal bounding boxes have one tree, whatever kernel or precision traverses it.
    for more in
        [&[][..], &[], &["--kernel", "scalar"], &["--precision", "f32"], &["--seed", "7", "--estimator", "bsdf"]]
    {
        let with = record(&render(folder.path(), more).with_code(0));
        if more.is_empty() || more[0] == "--kernel" {
            assert_eq!(with["checksum"], without["checksum"], "{more:?}");
            assert_eq!(with["box_tests"].is_null(), without["box_tests"].is_null());
        }
        assert!(with["build_s"].is_null(), "it would mix building and reading");
        let [file] = files(&trees).try_into().expect("one file");
        // A rewritten file would have another time.
        let found = (fs::metadata(&file).unwrap().modified().unwrap(), file);
        assert_eq!(kept.get_or_insert_with(|| found.clone()), &found);
    }
    render(folder.path(), &["--accelerator", "median"]).with_code(0);
    assert_eq!(files(&trees).len(), 2);
    render(folder.path(), &["--accelerator", "none"]).with_code(0);
    assert_eq!(files(&trees).len(), 2);
}

/// A damaged file may hold the last copy of something: the program reports it and does not replace it.
#[test]
fn a_damaged_file_is_refused_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), &[]).with_code(0);
    fs::remove_file(folder.path().join("x.pfm")).unwrap();
    let [file] = files(&folder.path().join("trees")).try_into().unwrap();
    let whole = fs::read(&file).unwrap();
    let other = [&whole[..1000], b"x", &whole[1001..]].concat();
    let cases = [(whole[..1000].to_vec(), "ends too soon"), (other, "SHA-256"), (Vec::new(), "ends too soon")];
    for (damaged, problem) in cases {
        fs::write(&file, &damaged).unwrap();
        let refused = render(folder.path(), &[]).with_code(2);
        let words = [file.file_name().unwrap().to_str().unwrap(), problem, "delete the file"];
        assert!(words.iter().all(|word| refused.err.contains(word)), "{words:?}: {}", refused.err);
        assert!(fs::read(&file).unwrap() == damaged && !folder.path().join("x.pfm").exists());
    }
    fs::remove_file(&file).unwrap();
    render(folder.path(), &[]).with_code(0);
    assert!(fs::read(&file).unwrap() == whole);
}

#[test]
fn impossible_folders_are_refused_before_any_work() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), TINY);
    fs::write(folder.path().join("file"), "mine").unwrap();
    let long = "x".repeat(300);
    let cases =
        [("file", "is not a folder"), ("file/x", "not a folder"), ("no/x", "does not exist"), (&long, "too long")];
    for (cache, problem) in cases {
        let render = ["render", "spheres:5000", "--size", "16x12", "--cache", cache, "-o", "x.pfm"];
        let run = ["run", "tiny.toml", "--out", "out", "--cache", cache];
        for arguments in [&render[..], &run] {
            let refused = finish(pathmark(folder.path(), arguments)).with_code(2);
            assert!(refused.err.contains("cache = ") && refused.err.contains(problem), "{}", refused.err);
        }
    }
    // If other input is refused or nothing is cached, no folder is made.
    render(folder.path(), &["--strategy", "nonsense"]).with_code(2);
    render(folder.path(), &["--accelerator", "none"]).with_code(0);
    finish(pathmark(folder.path(), &["render", "mandelbrot", "--cache", "trees"])).with_code(2);
    let small = ["render", "cornell", "--size", "16x12", "--spp", "4", "--cache", "trees", "--json", "-o", "x.pfm"];
    let small = record(&finish(pathmark(folder.path(), &small)).with_code(0));
    assert!(small["build_s"].is_number());
    let names: Vec<_> = files(folder.path()).iter().map(|path| path.file_name().unwrap().to_owned()).collect();
    assert_eq!(names, ["file", "tiny.toml", "x.pfm"]);
}

/// Every command that builds a tree uses the cached one.
#[test]
fn all_commands_share_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let scene = ["spheres:5000", "--size", "16x12", "--estimator", "bsdf", "--cache", "trees"];
    let commands: [&[&str]; 5] = [
        &["render", "--spp", "1", "-o", "x.pfm"],
        &["inspect", "rays", "--repetitions", "1"],
        &["inspect", "bounces", "--spp", "2"],
        &["inspect", "path", "--pixel", "8,6"],
        &["price", "--rmse", "1", "--pilot-spp", "1", "--pilot-seeds", "3"],
    ];
    for command in commands {
        finish(pathmark(folder.path(), &[command, &scene].concat())).with_code(0);
        assert_eq!(files(&folder.path().join("trees")).len(), 1, "{command:?}");
    }
}

/// Cells run in separate processes, and each would build the tree again.
#[test]
fn cells_of_a_sweep_share_trees() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), TINY);
    let large = ["run", "tiny.toml", "--out", "out", "--repetitions", "1", "--set", "scene=spheres:5000"];
    finish(pathmark(folder.path(), &[&large[..], &["--cache", "trees"]].concat())).with_code(0);
    assert_eq!(files(&folder.path().join("trees")).len(), 1);
    let mut rows = csv::Reader::from_path(folder.path().join("out/tiny/records.csv")).unwrap();
    let build_s = rows.headers().unwrap().iter().position(|name| name == "build_s").unwrap();
    let rows: Vec<_> = rows.records().map(Result::unwrap).collect();
    assert!(rows.len() > 1 && rows.iter().all(|row| row[build_s].is_empty()));
    // Rows with a build time are not added to rows without one.
    let without = finish(pathmark(folder.path(), &[&large[..], &["--resume"]].concat())).with_code(2);
    assert!(without.err.contains("cache"), "{}", without.err);
}
