//! One image by several processes: MPI as the system has it. Without `mpiexec` these tests say so and pass.

use crate::program::{Finished, finish, pathmark, wait};
use crate::watchdog::Watchdog;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

const RULES: [&str; 12] = [
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

fn is_launcher(name: &str) -> bool {
    Command::new(name).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// Whether processes can be started; says so if not.
fn has_launcher() -> bool {
    let found = is_launcher("mpiexec");
    if !found {
        println!("no mpiexec: nothing was tested (Debian: apt install mpich)");
    }
    found
}

/// Open MPI asks for words that MPICH does not know: more processes than processors, and root.
const OPEN_MPI: [(&str, &str); 4] = [
    ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
    ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
    ("OMPI_MCA_rmaps_base_oversubscribe", "1"),
    ("PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe"),
];

fn launcher(folder: &Path) -> Command {
    launcher_named("mpiexec", folder)
}

fn launcher_named(name: &str, folder: &Path) -> Command {
    let mut command = Command::new(name);
    command.current_dir(folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.envs(OPEN_MPI);
    command
}

fn program() -> PathBuf {
    assert_cmd::cargo::cargo_bin!("pathmark").to_path_buf()
}

fn ranks(folder: &Path, count: usize, arguments: &[&str]) -> Finished {
    let mut command = launcher(folder);
    command.arg("-n").arg(count.to_string()).arg(program()).args(arguments);
    finish(command)
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error} in {text}"))
}

/// Every rule, and for one of each way more ranks than jobs, threads and precisions: the checksum of one process.
#[test]
fn every_rule_gives_the_image_of_one_process() {
    if !has_launcher() {
        return;
    }
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let alone = |options: &[&str]| {
        let finished = finish(pathmark(folder.path(), &[&SCENE, options, &["--json"]].concat())).with_code(0);
        json(&finished.out)["checksum"].clone()
    };
    let together = |count: usize, rule: &str, options: &[&str], expected: &Value| {
        let options = [&SCENE, options, &["--json", "--ranks", rule]].concat();
        let found = json(&ranks(folder.path(), count, &options).with_code(0).out);
        assert_eq!(&found["checksum"], expected, "{count} ranks by {rule}, {options:?}");
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
        for count in [2, 3] {
            together(count, rule, &serial, &expected);
        }
        if !rule.starts_with("master-worker") {
            together(1, rule, &serial, &expected);
        }
    }
    for rule in ["static-cyclic", "guided", "adaptive-factoring", "master-worker:3"] {
        // More ranks than rows of tiles, and pieces of some of a pixel's samples.
        let threads = ["--threads", "2", "--decomposition", "samples:16:32x32"];
        together(5, rule, &threads, &expected);
        let single = ["--threads", "2", "--precision", "f32", "--strategy", "static-blocks"];
        together(2, rule, &single, &alone(&single));
    }
    together(8, "dynamic:3", &["--threads", "2", "--strategy", "thread-per-row"], &expected);
}

/// Debian's launchers stand beside each other under these names, each with its own library: one checksum.
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

#[test]
fn what_ranks_cannot_do_is_refused() {
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
    refused(&["--ranks", "guided", "--mpi", "libc.so.6"], 2, &["mpi", "libc.so.6", "MPI_Init_thread"]);
    refused(&["--mpi", "auto"], 2, &["--ranks"]);
    for option in [["--target-error", "0.1"], ["--checkpoint", "c"], ["--shard", "1/2"]] {
        refused(&[&["--ranks", "guided", "-o", "x"], option.as_slice()].concat(), 2, &["--ranks", option[0]]);
    }
    // A launcher that the library knows nothing of: each process would be alone, and render all of the image.
    let mut command = pathmark(folder.path(), &[&SCENE, ["--ranks", "guided"].as_slice()].concat());
    command.envs([("OMPI_COMM_WORLD_SIZE", "3"), ("OMPI_COMM_WORLD_RANK", "0")]);
    let finished = finish(command);
    assert!(finished.code == Some(3) && finished.err.contains("mpiexec"), "{:?} {}", finished.code, finished.err);
}

/// What messages cost is told by rank 0 alone, medians within their intervals.
#[test]
fn what_messages_cost_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let alone = finish(pathmark(folder.path(), &["message-costs", "--mpi", "/etc/passwd"])).with_code(2);
    assert!(alone.err.contains("/etc/passwd"), "{}", alone.err);
    if !has_launcher() {
        return;
    }
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let found = json(&ranks(folder.path(), 3, &["message-costs", "--json"]).with_code(0).out);
    let costs = found["costs"].as_array().unwrap();
    assert_eq!((&found["ranks"], costs.len()), (&3.into(), 5));
    for cost in costs {
        let [low, median, high] = ["low_s", "median_s", "high_s"].map(|key| cost[key].as_f64().unwrap());
        assert!(0.0 < low && low <= median && median <= high && high < 10.0, "{cost}");
    }
    assert!(ranks(folder.path(), 2, &["message-costs"]).with_code(0).out.contains("a fetch-and-op, waits"));
}

/// Ranks that were given another scene, seed or rule say so instead of making an image of two.
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

/// The processes that run this program, by number.
fn processes_of(program: &Path, launcher: u32) -> Vec<u32> {
    let is_below = |mut pid: u32| loop {
        let Ok(stat) = fs::read_to_string(format!("/proc/{pid}/stat")) else { return false };
        let parent = stat.rsplit_once(')').and_then(|(_, rest)| rest.split_whitespace().nth(1)?.parse().ok());
        match parent {
            Some(parent) if parent == launcher => return true,
            Some(parent) if parent > 1 => pid = parent,
            _ => return false,
        }
    };
    let all = fs::read_dir("/proc").unwrap().filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    all.filter(|pid| runs(program, *pid)).filter(|pid| is_below(*pid)).collect()
}

fn runs(program: &Path, pid: u32) -> bool {
    fs::read_link(format!("/proc/{pid}/exe")).is_ok_and(|exe| exe == program)
}

const KILLS: u64 = if cfg!(debug_assertions) { 3 } else { 6 };

/// A rank that dies (SIGKILL) ends all ranks, with an error and without an image. The launcher of Open MPI 4.1.4 sometimes waits for a lock of its
/// own for ever after it has ended them all, so it is killed then.
#[test]
fn a_rank_that_dies_ends_the_run() {
    if !has_launcher() {
        return;
    }
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let program = fs::canonicalize(program()).unwrap();
    for kill in 0..KILLS {
        let mut command = launcher(folder.path());
        let long = ["render", "cornell", "--spp", "20000", "--size", "64x48", "--threads", "1", "-o", "a.png"];
        let rule = ["dynamic:1", "working-master:1", "static-cyclic"][kill as usize % 3];
        command.args(["-n", "3"]).arg(&program).args(long).args(["--ranks", rule]);
        let mut child = command.spawn().unwrap();
        let found = loop {
            let found = processes_of(&program, child.id());
            if found.len() == 3 {
                break found;
            }
            std::thread::sleep(Duration::from_millis(5));
        };
        std::thread::sleep(Duration::from_millis(100 * kill));
        // Any of the three, rank 0 included.
        let victim = found[kill as usize % 3];
        let killed = Command::new("kill").args(["-9", &victim.to_string()]).status().unwrap();
        assert!(killed.success());
        while found.iter().any(|pid| runs(&program, *pid)) {
            std::thread::sleep(Duration::from_millis(5));
        }
        if child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_secs(3));
            // It may have ended meanwhile.
            let _ = child.kill();
        }
        let finished = wait(child);
        assert_ne!(finished.code, Some(0), "{rule}");
        assert!(!folder.path().join("a.png").exists());
    }
}

/// Rows of processes stand among those of threads, with one checksum; without a launcher they say that nothing was measured.
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
        // A rank or a thread that comes late may find nothing left, unless jobs are dealt.
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
