//! The command line does what its help says: every name that `list` prints runs as it is, and what one verb writes another reads.

#[path = "support/experiment.rs"]
mod experiment;
#[path = "support/program.rs"]
mod program;

use experiment::{TINY, write_tiny};
use program::{Finished, finish, pathmark};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

const KINDS: [&str; 11] = [
    "scenes",
    "strategies",
    "decompositions",
    "estimators",
    "samplers",
    "kernels",
    "effects",
    "materials",
    "metrics",
    "formats",
    "experiments",
];

/// Columns of `records.csv` that say what a row is of and what it measured.
const COLUMNS: [&str; 34] = [
    "schema",
    "experiment",
    "cell",
    "scene",
    "effects",
    "width",
    "height",
    "spp",
    "seed",
    "estimator",
    "sampler",
    "kernel",
    "precision",
    "biased",
    "decomposition",
    "strategy",
    "threads",
    "repetition",
    "order",
    "jobs",
    "workers_used",
    "setup_s",
    "makespan_s",
    "merge_s",
    "busy_sum_s",
    "busy_max_s",
    "paths",
    "rays",
    "invalid_samples",
    "checksum",
    "warnings",
    "error",
    "commit",
    "started_utc",
];

fn run(folder: &Path, arguments: &[&str]) -> Finished {
    finish(pathmark(folder, arguments)).with_code(0)
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error} in {text}"))
}

/// The names that `list KIND` prints.
fn names(kind: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let listed = json(&run(folder.path(), &["list", kind, "--json"]).out);
    let items = listed.as_array().unwrap_or_else(|| panic!("{kind} is no array"));
    let text = |item: &Value, key: &str| item[key].as_str().filter(|text| !text.is_empty()).map(str::to_string);
    let name = |item| text(item, "about").and(text(item, "name")).unwrap_or_else(|| panic!("{kind}: {item}"));
    items.iter().map(name).collect()
}

/// The record of a tiny render with some options.
fn record(folder: &Path, scene: &str, options: &[&str]) -> Value {
    let base = ["render", scene, "--size", "24x16", "--spp", "4", "--json", "-o", "image.png"];
    let finished = run(folder, &[base.as_slice(), options].concat());
    assert_eq!(finished.out.trim_end().lines().count(), 1, "one object on one line: {}", finished.out);
    json(&finished.out)
}

#[test]
fn every_kind_is_listed_with_name_and_about() {
    for kind in KINDS {
        let names = names(kind);
        assert!(!names.is_empty(), "{kind}");
        assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len(), "{kind}: a name twice in {names:?}");
    }
    // And all of them at once.
    let folder = tempfile::tempdir().unwrap();
    let all = json(&run(folder.path(), &["list", "--json"]).out);
    let kinds: BTreeSet<_> = all.as_array().unwrap().iter().filter_map(|item| item["kind"].as_str()).collect();
    assert_eq!(kinds, BTreeSet::from(KINDS));
    let text = run(folder.path(), &["list"]).out;
    assert!(KINDS.iter().all(|kind| text.lines().any(|line| line == *kind)), "{text}");
}

#[test]
fn every_listed_name_runs_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    for (kind, option) in [("estimators", "--estimator"), ("samplers", "--sampler"), ("kernels", "--kernel")] {
        for name in names(kind) {
            let column = option.trim_start_matches('-');
            assert_eq!(record(folder.path(), "cornell", &[option, &name])[column], name.as_str());
        }
    }
    for scene in names("scenes") {
        assert_eq!(record(folder.path(), &scene, &[])["scene"], scene.as_str());
    }
}

/// A profile runs where it covers the scene; a scene of one diffuse ball is covered by all.
#[test]
fn every_effect_profile_runs_and_gives_the_same_image() {
    let folder = tempfile::tempdir().unwrap();
    let (camera, _) = include_str!("../experiments/scenes/cornell.toml").split_once("[[objects]]").unwrap();
    let ball = "[[objects]]\nname = \"ball\"\nshape = { sphere = { center = [50.0, 40.0, 80.0], radius = 20.0 } }\n\
                material = { diffuse = { albedo = [0.5, 0.5, 0.5] } }\nemission = [1.0, 1.0, 1.0]\n";
    fs::write(folder.path().join("ball.toml"), format!("{camera}{ball}")).unwrap();
    let mut checksums = BTreeSet::new();
    for effects in names("effects") {
        let record = record(folder.path(), "ball.toml", &["--effects", &effects]);
        assert_eq!(record["effects"], effects.as_str());
        checksums.insert(record["checksum"].as_str().unwrap().to_string());
    }
    assert_eq!(checksums.len(), 1, "{checksums:?}");
}

#[test]
fn every_schedule_gives_the_same_checksum() {
    let folder = tempfile::tempdir().unwrap();
    let mut checksums = BTreeSet::new();
    let mut check = |options: &[&str]| {
        let record = record(folder.path(), "cornell", options);
        checksums.insert(record["checksum"].as_str().filter(|text| text.len() == 16).unwrap().to_string());
        let missing: Vec<_> = COLUMNS.iter().filter(|column| record.get(column).is_none()).collect();
        assert!(missing.is_empty(), "{missing:?}");
        assert_eq!(record["paths"], 24 * 16 * 4);
        record
    };
    for strategy in names("strategies") {
        for threads in ["1", "3"] {
            let record = check(&["--strategy", &strategy, "--threads", threads]);
            assert_eq!(record["strategy"], strategy.as_str());
        }
    }
    for decomposition in names("decompositions") {
        assert_eq!(check(&["--decomposition", &decomposition])["decomposition"], decomposition.as_str());
    }
    let per_row = check(&["--strategy", "thread-per-row"]);
    assert_eq!((&per_row["jobs"], &per_row["workers_used"]), (&Value::from(16), &Value::from(16)));
    assert_eq!(per_row["decomposition"], "rows");
    assert_eq!(checksums.len(), 1, "{checksums:?}");
}

/// Rendered to the same bits, so what is left is the format's own rounding (and, in display formats, the clamp).
#[test]
fn every_format_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), "cornell", &["--seed", "3", "-o", "reference.pfm"]);
    for format in names("formats") {
        let image = format!("image.{format}");
        record(folder.path(), "cornell", &["--seed", "3", "-o", &image]);
        // A display image is compared with itself in another display format.
        let display = ["png", "ppm", "bmp"].contains(&format.as_str());
        if display {
            record(folder.path(), "cornell", &["--seed", "3", "-o", "display.png"]);
        }
        let reference = if display { "display.png" } else { "reference.pfm" };
        let metrics = json(&run(folder.path(), &["compare", &image, reference, "--json"]).out);
        let rmse = metrics["rmse"].as_f64().unwrap();
        // The shared exponent of .hdr leaves 8 bits to each channel of values up to 12.
        let allowed = if format == "hdr" { 0.05 } else { 1e-6 };
        assert!(rmse <= allowed, "{format}: {rmse}");
    }
}

#[test]
fn quiet_is_quiet_and_talk_goes_to_stderr() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), TINY);
    let render = ["render", "cornell", "--size", "8x8", "--spp", "4"];
    let sweep = ["run", "tiny.toml", "--out", "out"];
    let reference = ["reference", "cornell", "--size", "8x8", "--spp", "4"];
    for arguments in [render.as_slice(), &sweep, &reference] {
        let finished = run(folder.path(), &[arguments, &["--quiet"]].concat());
        assert_eq!(finished.err, "", "{arguments:?}");
        assert_ne!(finished.out, "", "{arguments:?}");
    }
    // Without a name the image is called after its scene.
    assert!(folder.path().join("cornell.png").is_file());
    fs::remove_dir_all(folder.path().join("out")).unwrap();
    let finished = run(folder.path(), &sweep);
    assert!(finished.err.contains("tiny") && finished.out.lines().count() == 1, "{}{}", finished.err, finished.out);
}

#[test]
fn a_reference_is_cached_and_a_heat_map_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let reference = ["reference", "cornell", "--size", "24x16", "--spp", "16", "--out", "films"];
    let first = run(folder.path(), &reference).out;
    let films: Vec<&str> = first.lines().take(2).collect();
    let bytes: Vec<_> = films.iter().map(|film| fs::read(folder.path().join(film)).unwrap()).collect();
    assert_ne!(bytes[0], bytes[1], "the halves are independent");
    let second = run(folder.path(), &reference);
    assert_eq!(second.out, first);
    assert!(!second.err.contains("reference 1 of 2"), "rendered again: {}", second.err);

    record(folder.path(), "cornell", &["--seed", "1", "-o", "a.pfm"]);
    record(folder.path(), "cornell", &["--seed", "2", "-o", "b.exr"]);
    let compared = run(folder.path(), &["compare", "a.pfm", "b.exr", "--heatmap", "map.png"]).out;
    for metric in names("metrics") {
        assert!(compared.lines().any(|line| line.starts_with(&metric)), "{metric} is not in {compared}");
    }
    assert_png(&folder.path().join("map.png"));
    let same = json(&run(folder.path(), &["compare", "a.pfm", "a.pfm", "--json"]).out);
    assert_eq!(same["rmse"], 0.0);
}

fn assert_png(path: &Path) {
    let bytes = fs::read(path).unwrap();
    assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.len() > 100, "{}", path.display());
}

/// As far as it goes without a parser: elements are closed in the order in which they were opened.
fn assert_svg(path: &Path) {
    let text = fs::read_to_string(path).unwrap();
    let mut open = Vec::new();
    for tag in text.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').unwrap_or_else(|| panic!("{}: no end of {tag:.40}", path.display()));
        let name = tag.trim_start_matches('/').split([' ', '\n', '/']).next().unwrap();
        match tag {
            _ if tag.starts_with(['?', '!']) || tag.ends_with('/') => {}
            _ if tag.starts_with('/') => assert_eq!(open.pop(), Some(name), "{}", path.display()),
            _ => open.push(name),
        }
    }
    assert!(open.is_empty() && text.contains("<svg") && !text.contains("NaN"), "{}: {open:?}", path.display());
}

#[test]
fn a_run_leaves_rows_figures_and_a_page_that_report_draws_again() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), TINY);
    run(folder.path(), &["run", "tiny.toml", "--out", "out"]);
    let out = folder.path().join("out");
    let figures = out.join("tiny/figures");
    let listed = |folder: &Path| {
        let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.collect::<BTreeSet<_>>()
    };
    let (first, page) = (listed(&figures), fs::read_to_string(out.join("report.html")).unwrap());
    fs::remove_dir_all(&figures).unwrap();
    fs::remove_file(out.join("report.html")).unwrap();
    run(folder.path(), &["report", "out"]);
    assert_eq!(listed(&figures), first);
    assert_eq!(fs::read_to_string(out.join("report.html")).unwrap(), page, "the page follows from the rows alone");

    let svgs: Vec<_> = first.iter().filter_map(|name| name.strip_suffix(".svg")).collect();
    assert!(!svgs.is_empty(), "{first:?}");
    for stem in svgs {
        assert_svg(&figures.join(format!("{stem}.svg")));
        assert_png(&figures.join(format!("{stem}.png")));
    }
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("</html>") && page.contains("Does it run?"));
    assert!(!page.contains("src=\"http") && !page.contains("href=\"http"), "the page needs a network");
}
