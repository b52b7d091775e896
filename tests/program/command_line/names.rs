//! The names that `list` prints, and those in records.

use super::{json, names, record, run};
use crate::program::{finish, in_memory, pathmark};
use serde_json::Value;
use std::collections::BTreeSet;

const KINDS: [&str; 25] = [
    "scenes",
    "workloads",
    "strategies",
    "decompositions",
    "outputs",
    "estimators",
    "samplers",
    "kernels",
    "keys",
    "simd",
    "devices",
    "effects",
    "accelerators",
    "cameras",
    "shapes",
    "generators",
    "materials",
    "features",
    "filters",
    "metrics",
    "formats",
    "experiments",
    "figures",
    "columns",
    "warnings",
];

/// Columns of `records.csv` that identify a row and hold its measurements.
const COLUMNS: [&str; 39] = [
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
    "output",
    "threads",
    "repetition",
    "run_order",
    "jobs",
    "workers_used",
    "pilot_s",
    "strategy_setup_s",
    "makespan_s",
    "merge_s",
    "busy_sum_s",
    "busy_max_s",
    "idle_between_jobs_s",
    "idle_tail_s",
    "other_cpu_s",
    "samples",
    "rays",
    "invalid_samples",
    "checksum",
    "warnings",
    "error",
    "commit",
    "started_utc",
];

#[test]
fn warnings_are_explained_as_rows_have_them() {
    let folder = in_memory();
    let all = json(&run(folder.path(), &["list", "warnings", "--json"]).out);
    for entry in all.as_array().unwrap() {
        let [name, about, advice] = ["name", "about", "advice"].map(|key| entry[key].as_str().unwrap());
        let alone = run(folder.path(), &["list", "warnings", &format!("{name}(25 %)")]).out;
        let lines: Vec<&str> = alone.lines().map(str::trim).collect();
        assert_eq!(lines, [&format!("{name}  {about}"), advice], "its name, its meaning and what to do");
    }
}

/// The keys of a table are listed by its name.
#[test]
fn keys_are_listed_by_table() {
    let folder = in_memory();
    let listed = |table: &str| {
        let all = json(&run(folder.path(), &["list", "keys", table, "--json"]).out);
        let text = |item: &Value, key: &str| item[key].as_str().unwrap().to_string();
        all.as_array().unwrap().iter().map(|item| (text(item, "name"), text(item, "about"))).collect::<Vec<_>>()
    };
    let scene = listed("scene");
    assert!(scene.len() > 60 && scene.iter().all(|(name, _)| name.starts_with("scene.")), "{scene:?}");
    let view = scene.iter().find(|(name, _)| name == "scene.camera.pinhole.field-of-view").unwrap();
    assert!(view.1.ends_with("[number, 1e-6 to 179 degrees; required]"), "{view:?}");
    assert_eq!(listed("scene.fog").len(), 4, "the table and its keys");
    assert!(listed("matrix").iter().any(|(name, _)| name == "matrix.spp"));
    let refused = finish(pathmark(folder.path(), &["list", "keys", "scen"])).with_code(2);
    assert!(refused.err.contains("none of the keys"), "{}", refused.err);
}

/// Names of version 0.1 mean what today's names mean.
#[test]
fn old_names_are_read() {
    let folder = in_memory();
    for (old, new) in [
        ("bounces", "inspect bounces"),
        ("check", "selftest"),
        ("compare", "image compare"),
        ("completions", "shell completions"),
        ("convert", "image convert"),
        ("explain", "list"),
        ("man", "shell man"),
        ("message-costs", "inspect messages"),
        ("rays", "inspect rays"),
        ("reference", "image reference"),
        ("replay", "inspect path"),
        ("trace", "inspect jobs"),
    ] {
        let new: Vec<&str> = ["--quiet"].into_iter().chain(new.split(' ')).chain(["--help"]).collect();
        assert_eq!(run(folder.path(), &["--quiet", old, "--help"]).out, run(folder.path(), &new).out, "{old}");
    }
    assert!(run(folder.path(), &["explain", "drift"]).out.trim_start().starts_with("drift  "));
    // These options are read: the error names the value under today's name.
    for (old, said) in [
        (&["run", "granularity", "--against", "nowhere"][..], "baseline = nowhere"),
        (&["run", "granularity", "--until", "3%", "--within", "soon"], "max-time = soon"),
        (&["price", "cornell", "--rmse", "0", "--pay"], "rmse = 0"),
    ] {
        let refused = finish(pathmark(folder.path(), old)).with_code(2);
        assert!(refused.err.contains(said), "{old:?}: {}", refused.err);
    }
}

/// Files that `new` writes run as they are, and `new` never replaces an existing file.
#[test]
fn starters_run_as_they_are() {
    let folder = in_memory();
    for (kind, name) in [("experiment", "mine"), ("scene", "room.toml")] {
        run(folder.path(), &["new", kind, name]);
        let refused = finish(pathmark(folder.path(), &["new", kind, name])).with_code(2);
        assert!(refused.err.contains("already exists"), "{}", refused.err);
    }
    run(folder.path(), &["run", "mine.toml", "--repetitions", "1"]);
    run(folder.path(), &["render", "room.toml", "--size", "24x16", "--spp", "4"]);
    assert!(folder.path().join("out/mine/figures/speedup.svg").is_file());
}

#[test]
fn every_kind_is_listed_with_name_and_about() {
    for kind in KINDS {
        let names = names(kind);
        assert!(!names.is_empty(), "{kind}");
        assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len(), "{kind}: a name twice in {names:?}");
    }
    // All kinds at once.
    let folder = in_memory();
    let all = json(&run(folder.path(), &["list", "--json"]).out);
    let kinds: BTreeSet<_> = all.as_array().unwrap().iter().filter_map(|item| item["kind"].as_str()).collect();
    assert_eq!(kinds, BTreeSet::from(KINDS));
    let text = run(folder.path(), &["list"]).out;
    assert!(KINDS.iter().all(|kind| text.lines().any(|line| line == *kind)), "{text}");
}

/// A record names what was asked for, as the list names it. In the library every name runs (`every_scene`,
/// `schedule_invariance`, `workloads`).
#[test]
fn a_record_has_the_names_of_the_list() {
    let folder = in_memory();
    let kinds = [
        ("estimators", "estimator"),
        ("samplers", "sampler"),
        ("kernels", "kernel"),
        ("effects", "effects"),
        ("strategies", "strategy"),
        ("decompositions", "decomposition"),
        ("outputs", "output"),
    ];
    let usual = record(folder.path(), "cornell", &[]);
    for (kind, column) in kinds {
        // Neither the default nor the first one: the effects `diffuse` do not cover the scene.
        let names = names(kind);
        let name = names.iter().skip(1).find(|name| usual[column] != name.as_str()).unwrap();
        let record = record(folder.path(), "cornell", &[&format!("--{column}"), name]);
        assert_eq!(record[column], name.as_str());
    }
    for scene in [names("scenes"), names("workloads")].iter().filter_map(|all| all.last()) {
        assert_eq!(record(folder.path(), scene, &[])["scene"], scene.as_str());
    }
    let per_row = record(folder.path(), "cornell", &["--strategy", "thread-per-row"]);
    assert_eq!((&per_row["jobs"], &per_row["workers_used"]), (&Value::from(16), &Value::from(16)));
    assert_eq!((&per_row["decomposition"], &per_row["samples"]), (&"rows".into(), &Value::from(24 * 16 * 4)));
    let missing: Vec<_> = COLUMNS.iter().filter(|column| per_row.get(column).is_none()).collect();
    assert!(missing.is_empty() && per_row["checksum"].as_str().map(str::len) == Some(16), "{missing:?}");
}
