//! `--cache FOLDER`: hierarchies of large scenes are built once, whoever asks next and for whatever image.

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
    // The same boxes have one tree, whoever looks into it.
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
        // Another file in its place would have another time.
        let found = (fs::metadata(&file).unwrap().modified().unwrap(), file);
        assert_eq!(kept.get_or_insert_with(|| found.clone()), &found);
    }
    render(folder.path(), &["--accelerator", "median"]).with_code(0);
    assert_eq!(files(&trees).len(), 2);
    render(folder.path(), &["--accelerator", "none"]).with_code(0);
    assert_eq!(files(&trees).len(), 2);
}

/// A damaged file may be all that is left of something: it is told and not replaced.
#[test]
fn a_damaged_tree_is_told_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), &[]).with_code(0);
    fs::remove_file(folder.path().join("x.pfm")).unwrap();
    let [file] = files(&folder.path().join("trees")).try_into().unwrap();
    let whole = fs::read(&file).unwrap();
    for damaged in [whole[..1000].to_vec(), [&whole[..1000], b"x", &whole[1001..]].concat(), Vec::new()] {
        fs::write(&file, &damaged).unwrap();
        let refused = render(folder.path(), &[]).with_code(3);
        let name = file.file_name().unwrap().to_str().unwrap();
        assert!(refused.err.contains(name), "{}", refused.err);
        assert!(fs::read(&file).unwrap() == damaged && !folder.path().join("x.pfm").exists());
    }
    fs::remove_file(&file).unwrap();
    render(folder.path(), &[]).with_code(0);
    assert!(fs::read(&file).unwrap() == whole);
}

#[test]
fn a_cache_that_is_no_folder_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("trees"), "mine").unwrap();
    let refused = render(folder.path(), &[]).with_code(2);
    assert!(refused.err.contains("cache = trees: is not a folder"), "{}", refused.err);
    assert_eq!(fs::read(folder.path().join("trees")).unwrap(), b"mine");
}

/// Cells are processes of their own, and each would build the tree again.
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
}
