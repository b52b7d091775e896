//! Guarantees for a crate outside Pathmark's repository.

use pathmark::measure::{Settings, Setup};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

fn outside(folder: &Path, arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_outside")).args(arguments).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn the_pool_keeps_the_contract() {
    pathmark::strategy::contract::verify(&outside::ENTRY).unwrap();
}

/// In the dev profile, whose stack frames are the largest, on the workers' own stacks.
#[test]
fn the_front_pages_example_runs_in_the_dev_profile() {
    let settings = Settings { spp: 4, decomposition: "tiles:8x8".into(), threads: 2, ..Settings::default() };
    for estimator in ["smallpt", "mis"] {
        let mut settings = settings.clone();
        (settings.spec.width, settings.spec.height, settings.spec.estimator) = (16, 12, estimator.into());
        let outcome = Setup::prepare(settings).unwrap().run(None).unwrap();
        assert_eq!(outcome.counts.paths, 16 * 12 * 4);
    }
}

#[test]
fn the_list_shows_own_entries() {
    let folder = tempfile::tempdir().unwrap();
    for (kind, name) in
        [("strategies", "relay"), ("estimators", "depth"), ("workloads", "primes"), ("experiments", "ours")]
    {
        let listed: Value = serde_json::from_str(&outside(folder.path(), &["list", kind, "--json"])).unwrap();
        let item = listed.as_array().unwrap().iter().find(|item| item["name"] == name);
        // `grade` asks for the strategies that a program adds.
        assert!(item.is_some_and(|item| kind != "strategies" || item["own"] == true), "{kind}: {listed}");
    }
}

/// A sweep over this crate's pool, estimator and workload: child processes have the same tables, each scene has one
/// checksum, and figures show them.
#[test]
fn experiments_compare_own_entries_with_built_in_ones() {
    let folder = tempfile::tempdir().unwrap();
    outside(folder.path(), &["run", "ours", "--out", "out", "--quiet"]);
    let rows = fs::read_to_string(folder.path().join("out/ours/records.csv")).unwrap();
    let mut lines = rows.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|own| *own == name).unwrap();
    let [scene, strategy, checksum] = ["scene", "strategy", "checksum"].map(column);
    let mut checksums = BTreeSet::new();
    let mut strategies = BTreeSet::new();
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        checksums.insert((fields[scene].to_string(), fields[checksum].to_string()));
        strategies.insert(fields[strategy].to_string());
    }
    assert_eq!(checksums.len(), 2, "{checksums:?}");
    assert!(strategies.contains("relay"), "{strategies:?}");
    // The program's name and version are its own.
    let machine = fs::read_to_string(folder.path().join("out/ours/machine.toml")).unwrap();
    assert!(machine.contains("program = \"relay-race 0.1.0 (Pathmark "), "{machine}");
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    for name in ["relay", "primes", "cornell"] {
        assert!(page.contains(name), "{name} is not in the report");
    }
}
