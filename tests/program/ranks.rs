//! One image by several processes, with the system's MPI. Without `mpiexec` these tests say so and pass.

use crate::program::{Finished, finish, pathmark};
use crate::watchdog::Watchdog;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

pub(crate) const RULES: [&str; 12] = [
    "static-blocks",
    "static-cyclic",
    "dynamic:3",
    "guided",
    "trapezoid",
    "factoring",
    "weighted-factoring:1:0.5",
    "awf-b",
    "awf-c",
    "adaptive-factoring",
    "master-worker:3",
    "working-master:3",
];
const SCENE: [&str; 6] = ["render", "cornell", "--spp", "20", "--size", "70x40"];

pub(crate) fn is_launcher(name: &str) -> bool {
    Command::new(name).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// Whether processes can be started; prints a line if not.
pub(crate) fn has_launcher() -> bool {
    let found = is_launcher("mpiexec");
    if !found {
        println!("no mpiexec: nothing was tested (Debian: apt install mpich)");
    }
    found
}

/// Permissions that Open MPI asks for, unlike MPICH: more processes than processors, and root.
const OPEN_MPI: [(&str, &str); 4] = [
    ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
    ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
    ("OMPI_MCA_rmaps_base_oversubscribe", "1"),
    ("PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe"),
];

pub(crate) fn launcher(folder: &Path) -> Command {
    launcher_named("mpiexec", folder)
}

pub(crate) fn launcher_named(name: &str, folder: &Path) -> Command {
    let mut command = Command::new(name);
    command.current_dir(folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.envs(OPEN_MPI);
    command
}

pub(crate) fn program() -> PathBuf {
    assert_cmd::cargo::cargo_bin!("pathmark").to_path_buf()
}

fn ranks(folder: &Path, count: usize, arguments: &[&str]) -> Finished {
    let mut command = launcher(folder);
    command.arg("-n").arg(count.to_string()).arg(program()).args(arguments);
    finish(command)
}

pub(crate) fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error} in {text}"))
}

/// Every rule gives the checksum of one process. One rule of each kind also runs with many ranks, with threads and in
/// f32.
#[test]
fn every_rule_gives_the_image_of_one_process() {
    if !has_launcher() {
        return;
    }
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let alone = |options: &[&str]| {
        let finished = finish(pathmark(folder.path(), &[&SCENE, options, &["--json"]].concat())).with_code(0);
        let found = json(&finished.out);
        [found["checksum"].clone(), found["max_radiance"].clone()]
    };
    let together = |count: usize, rule: &str, options: &[&str], expected: &[Value; 2]| {
        let options = [&SCENE, options, &["--json", "--ranks", rule]].concat();
        let found = json(&ranks(folder.path(), count, &options).with_code(0).out);
        // The brightest channel comes from the ranks' own maxima, exchanged before the pieces are gathered.
        let seen = [found["checksum"].clone(), found["max_radiance"].clone()];
        assert_eq!(&seen, expected, "{count} ranks by {rule}, {options:?}");
        let [makespan_s, merge_s, image_s] =
            ["makespan_s", "merge_s", "time_to_image_s"].map(|column| found[column].as_f64().unwrap());
        assert!(image_s >= makespan_s + merge_s, "{image_s} s, of which {makespan_s} and {merge_s}");
        assert_eq!((&found["ranks"], &found["rank_rule"]), (&count.into(), &rule.into()));
        let by_rank = found["by_rank"].as_array().unwrap();
        let jobs: u64 = by_rank.iter().map(|rank| rank["jobs"].as_u64().unwrap()).sum();
        assert_eq!((Some(jobs), by_rank.len()), (found["jobs"].as_u64(), count));
        if rule.starts_with("master-worker") {
            assert_eq!(by_rank[0]["jobs"], 0);
        }
    };
    let serial = ["--threads", "1", "--strategy", "serial", "--decomposition", "tiles:16x16"];
    let expected = alone(&serial);
    for rule in RULES {
        together(3, rule, &serial, &expected);
    }
    for rule in ["static-cyclic", "guided", "adaptive-factoring", "master-worker:3"] {
        // More ranks than rows of tiles, and pieces with some of a pixel's samples.
        let threads = ["--threads", "2", "--decomposition", "samples:16:32x32"];
        together(5, rule, &threads, &expected);
        let single = ["--threads", "2", "--precision", "f32", "--strategy", "static-blocks"];
        together(2, rule, &single, &alone(&single));
        if !rule.starts_with("master-worker") {
            together(1, rule, &serial, &expected);
        }
    }
    together(8, "dynamic:3", &["--threads", "2", "--strategy", "thread-per-row"], &expected);
}

/// Debian installs its launchers side by side under these names, each with its own library: one checksum.
#[test]
fn every_library_gives_the_image_of_one_process() {
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let options = ["--threads", "1", "--decomposition", "tiles:16x16", "--json"];
    let alone = json(&finish(pathmark(folder.path(), &[&SCENE[..], &options].concat())).with_code(0).out);
    for name in ["mpiexec.mpich", "mpiexec.openmpi"] {
        if !is_launcher(name) {
            println!("no {name}: its library was not tested");
            continue;
        }
        for (count, rule) in [(2, "static-cyclic"), (3, "guided"), (5, "master-worker:3"), (8, "awf-c")] {
            let mut command = launcher_named(name, folder.path());
            command.arg("-n").arg(count.to_string()).arg(program());
            command.args([&SCENE[..], &options, &["--ranks", rule]].concat());
            let found = json(&finish(command).with_code(0).out);
            assert_eq!((&found["checksum"], &found["ranks"]), (&alone["checksum"], &count.into()), "{name} by {rule}");
        }
    }
}

/// MPICH's launcher leaves each rank all processors, so both would choose the first. With a binding they differ.
#[test]
fn ranks_do_not_share_a_pinned_processor() {
    let name = "mpiexec.mpich";
    if !is_launcher(name) {
        println!("no {name}: nothing was tested");
        return;
    }
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let run = |bind: &[&str]| {
        let mut command = launcher_named(name, folder.path());
        command.args(bind).args(["-n", "2"]).arg(program()).args(SCENE);
        command.args(["--threads", "1", "--ranks", "guided", "--pin", "compact", "--json"]);
        finish(command)
    };
    let refused = run(&[]).with_code(2).err;
    assert!(refused.contains("pin = compact: ranks 0 and 1 would both pin a worker to processor"), "{refused}");
    if std::thread::available_parallelism().is_ok_and(|count| count.get() > 1) {
        let row = json(&run(&["-bind-to", "core"]).with_code(0).out);
        assert_eq!((&row["pin"], &row["ranks"]), (&"compact".into(), &2.into()));
    }
}

#[test]
fn options_that_ranks_lack_are_refused() {
    if !has_launcher() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let refused = |arguments: &[&str], code: i32, said: &[&str]| {
        let finished = finish(pathmark(folder.path(), &[&SCENE, arguments].concat())).with_code(code);
        assert!(said.iter().all(|text| finished.err.contains(text)), "{said:?} is not in {}", finished.err);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{arguments:?}");
    };
    for rule in ["work-stealing", "serial", "dynamic:0", "master-worker:x", ""] {
        refused(&["--ranks", rule], 2, &["ranks", "working-master"]);
    }
    refused(&["--ranks", "master-worker"], 2, &["ranks", "master-worker", "2 ranks"]);
    refused(&["--ranks", "guided", "--mpi", "/etc/passwd"], 2, &["mpi", "/etc/passwd"]);
    refused(&["--ranks", "guided", "--mpi", "/nowhere/libmpi.so"], 2, &["mpi", "/nowhere/libmpi.so"]);
    // Apple's systems have the C library under another name.
    let c_library = if cfg!(target_vendor = "apple") { "libSystem.B.dylib" } else { "libc.so.6" };
    refused(&["--ranks", "guided", "--mpi", c_library], 2, &["mpi", c_library, "MPI_Init_thread"]);
    refused(&["--mpi", "auto"], 2, &["--ranks"]);
    refused(&["--ranks", "guided", "-o", "x", "--shard", "1/2"], 2, &["--ranks", "--shard"]);
    refused(&["--ranks", "guided", "-o", "x.png", "--adaptive"], 2, &["--ranks", "--adaptive"]);
    // The library does not know this launcher: each process would be alone and render the whole image.
    let mut command = pathmark(folder.path(), &[&SCENE, ["--ranks", "guided"].as_slice()].concat());
    command.envs([("OMPI_COMM_WORLD_SIZE", "3"), ("OMPI_COMM_WORLD_RANK", "0")]);
    let finished = finish(command);
    assert!(finished.code == Some(3) && finished.err.contains("mpiexec"), "{:?} {}", finished.code, finished.err);
}

/// Rank 0 alone prints the costs of messages; each median lies within its interval.
#[test]
fn message_costs_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let alone = finish(pathmark(folder.path(), &["inspect", "messages", "--mpi", "/etc/passwd"])).with_code(2);
    assert!(alone.err.contains("/etc/passwd"), "{}", alone.err);
    if !has_launcher() {
        return;
    }
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let found = json(&ranks(folder.path(), 3, &["inspect", "messages", "--json"]).with_code(0).out);
    let costs = found["costs"].as_array().unwrap();
    assert_eq!((&found["ranks"], costs.len()), (&3.into(), 5));
    for cost in costs {
        let [low, median, high] = ["low_s", "median_s", "high_s"].map(|key| cost[key].as_f64().unwrap());
        assert!(0.0 < low && low <= median && median <= high && high < 10.0, "{cost}");
    }
    assert!(ranks(folder.path(), 2, &["inspect", "messages"]).with_code(0).out.contains("a fetch-and-op, waits"));
}

/// Ranks that were given another seed, decomposition or rule are refused; a mixed image would be wrong.
#[test]
fn ranks_that_would_render_something_else_are_refused() {
    if !has_launcher() {
        return;
    }
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let base = [&SCENE, ["--ranks", "guided"].as_slice()].concat();
    for other in [
        [&base, ["--seed", "2"].as_slice()].concat(),
        [&base, ["--decomposition", "rows"].as_slice()].concat(),
        base.iter().map(|word| if *word == "guided" { "factoring" } else { word }).collect(),
    ] {
        let mut command = launcher(folder.path());
        command.args(["-n", "1"]).arg(program()).args(&base).args([":", "-n", "1"]).arg(program()).args(&other);
        let finished = finish(command);
        assert!(finished.code != Some(0) && finished.err.contains("rank 1 would render"), "{}", finished.err);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

/// Ranks reach a target error with the samples and the image of one process.
#[test]
fn ranks_stop_at_the_accuracy_at_which_one_process_stops() {
    if !has_launcher() {
        return;
    }
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let until = ["render", "cornell", "--size", "70x40", "--threads", "1", "--target-error", "0.2", "--json"];
    let alone = json(&finish(pathmark(folder.path(), &until)).with_code(0).out);
    let together = json(&ranks(folder.path(), 2, &[&until[..], &["--ranks", "guided"]].concat()).with_code(0).out);
    for key in ["checksum", "spp", "target_error", "samples"] {
        assert_eq!(together[key], alone[key], "{key}");
    }
    // A rank that may not resume from a file says so, and the others end with it.
    fs::write(folder.path().join("c"), "no checkpoint").unwrap();
    let refused = [&SCENE[..], &["--threads", "1", "--ranks", "guided", "--checkpoint", "c"]].concat();
    let finished = ranks(folder.path(), 3, &refused).with_code(2);
    assert_eq!(finished.err.matches("checkpoint = c").count(), 1, "{}", finished.err);
}

/// Rows of processes stand beside those of threads, with one checksum. Without a launcher they report that nothing was
/// measured.
#[test]
fn processes_have_rows_in_an_experiment() {
    if !has_launcher() {
        return;
    }
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let text = r#"
title = "Processes"
chapter = "scheduling"
question = "Do they render?"
figures = ["speedup"]

[[matrix]]
scene = ["cornell"]
spp = [4]
strategy = ["serial"]
threads = [1]
decomposition = ["tiles:16x16"]

[[matrix]]
scene = ["cornell"]
spp = [4]
rank-rule = ["static-blocks", "guided", "working-master:2"]
ranks = [2]
strategy = ["serial", "rayon"]
threads = [2]
decomposition = ["tiles:16x16"]

[quick]
size = [64, 48]
repetitions = 2
"#;
    fs::write(folder.path().join("ranks.toml"), text).unwrap();
    let rows = |out: &str, launcher: Option<&str>| {
        let mut command = pathmark(folder.path(), &["run", "ranks.toml", "--out", out]);
        command.envs(OPEN_MPI).envs(launcher.map(|launcher| ("PATHMARK_MPIEXEC", launcher)));
        finish(command).with_code(0);
        let mut reader = csv::Reader::from_path(folder.path().join(out).join("ranks/records.csv")).unwrap();
        let heads = reader.headers().unwrap().clone();
        let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
        let columns = ["strategy", "threads", "workers_used", "checksum", "warnings", "ranks", "rank_rule"].map(column);
        let rows: Vec<_> =
            reader.records().map(|row| columns.map(|at| row.as_ref().unwrap()[at].to_string())).collect();
        rows
    };
    let found = rows("out", None);
    assert_eq!(found.len(), 14);
    for [strategy, threads, used, checksum, _, ranks, rule] in &found {
        assert_eq!(checksum, &found[0][3], "{strategy} by {rule}");
        assert_eq!(ranks, if rule.is_empty() { "" } else { "2" }, "{strategy} by {rule}");
        let each = if strategy == "serial" { "1" } else { "2" };
        assert_eq!(threads, each, "{strategy} by {rule}");
        let workers = each.parse::<usize>().unwrap() * ranks.parse().unwrap_or(1);
        // A rank or thread that starts late may find no job left, unless jobs are assigned in advance.
        let used: usize = used.parse().unwrap();
        let is_dealt = strategy == "serial" && (rule.is_empty() || rule == "static-blocks");
        assert!(used == workers || (!is_dealt && (1..workers).contains(&used)), "{strategy} by {rule}: {used}");
    }
    for [strategy, _, used, checksum, warnings, _, rule] in rows("without", Some("/nowhere/mpiexec")) {
        let is_alone = rule.is_empty();
        assert_eq!((checksum.is_empty(), used.is_empty()), (!is_alone, !is_alone), "{strategy} by {rule}");
        assert_eq!(warnings.contains("no-program"), !is_alone, "{strategy} by {rule}: {warnings}");
    }
}

/// Forecasts for processes that this machine does not have, from the trace of a serial run and a file of message costs.
/// Needs no MPI.
#[test]
fn processes_are_forecast_from_a_trace() {
    let folder = tempfile::tempdir().unwrap();
    let render = ["render", "cornell", "--spp", "4", "--size", "64x48", "--strategy", "serial", "--threads", "1"];
    let pieces = ["--decomposition", "tiles:8x8", "--trace", "run.csv", "-o", "a.png"];
    finish(pathmark(folder.path(), &[&render[..], &pieces].concat())).with_code(0);
    let cost = |operation: &str, rank_0: &str, median_s: f64| serde_json::json!({ "operation": operation, "rank_0": rank_0, "repetitions": 9, "median_s": median_s, "low_s": 0, "high_s": 1 });
    let costs = [
        cost("a request and its answer", "waits", 2e-6),
        cost("a fetch-and-op", "waits", 1.0),
        cost("a fetch-and-op", "computes, and looks every ms", 1.0),
        cost("a gather of 5 MB from each rank", "gathers", 0.01),
    ];
    let messages = serde_json::json!({ "ranks": 2, "mpi": "MPICH 4.0.2", "costs": costs });
    fs::write(folder.path().join("messages.json"), messages.to_string()).unwrap();
    let simulate = |more: &[&str]| {
        let own = ["simulate", "run.csv", "--workers", "1,4", "--strategies", "shared-counter", "--no-check"];
        pathmark(folder.path(), &[&own[..], more].concat())
    };
    let rules = ["--ranks", "static-cyclic,dynamic:1", "--nodes", "1,4", "--messages", "messages.json"];
    finish(simulate(&rules)).with_code(0);
    let mut table = csv::Reader::from_path(folder.path().join("out/simulation/ranks-forecast.csv")).unwrap();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    let told: Vec<[&str; 3]> = rows.iter().map(|row| [0, 1, 2].map(|column| &row[column])).collect();
    let expected = ["static-cyclic", "dynamic:1"].into_iter().flat_map(|rule| {
        [["1", "1"], ["4", "1"], ["1", "4"], ["4", "4"]].map(|[ranks, threads]| [rule, ranks, threads])
    });
    assert_eq!(told, expected.collect::<Vec<_>>());
    let number = |row: usize, column: usize| rows[row][column].parse::<f64>().unwrap();
    assert!((0.9..=1.0).contains(&number(0, 4)), "one process of one thread: {}", number(0, 4));
    for row in 0..4 {
        // The speedup takes four columns, so the efficiency is in column 8.
        assert!(number(row, 4) <= number(row, 8) * (1.0 + 1e-9) * [1.0, 4.0, 4.0, 16.0][row], "{:?}", rows[row]);
        // Ranks that wait a second for an answer leave rank 0 alone, and the run waits for them.
        assert!(row % 2 == 0 || number(4 + row, 3) >= 1.0, "{:?}", rows[4 + row]);
    }
    let refused = |more: &[&str], said: &[&str]| {
        let finished = finish(simulate(more)).with_code(2);
        assert!(said.iter().all(|text| finished.err.contains(text)), "{said:?} is not in {}", finished.err);
    };
    refused(&["--ranks", "work-stealing"], &["ranks", "work-stealing", "working-master"]);
    refused(&["--nodes", "2"], &["--ranks"]);
    refused(&["--ranks", "guided", "--nodes", "0"], &["nodes = 0"]);
    refused(&["--ranks", "guided", "--messages", "run.csv"], &["messages = run.csv", "inspect messages"]);
    refused(&["--ranks", "guided", "--messages", "nowhere.json"], &["nowhere.json"]);
}
