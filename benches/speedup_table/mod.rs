//! The table that `cargo bench` ends with: speedups against `serial`, from the medians that criterion has just stored.
//!
//! Criterion calls its files a private detail, so this is the only place that reads them; what is missing or unreadable is left out.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// One case: name, threads, median seconds and its interval.
struct Case {
    strategy: String,
    threads: String,
    median_s: [f64; 3],
}

/// Prints the table of a group from what was stored since `start`, unless there is nothing to print, as under `cargo bench -- --test`.
pub(crate) fn print(group: &str, start: SystemTime) {
    let mut cases = Vec::new();
    collect(&stored().join(group), start, &mut cases);
    let Some(serial) = cases.iter().find(|case| case.strategy == "serial").map(|case| case.median_s) else { return };
    let mut rows: BTreeMap<(String, String), [f64; 3]> = BTreeMap::new();
    for case in cases {
        // The widest ratio that the two intervals allow: serial low over high, serial high over low.
        let speedup = [serial[0] / case.median_s[0], serial[1] / case.median_s[2], serial[2] / case.median_s[1]];
        rows.insert((case.strategy, case.threads), speedup);
    }
    println!("\nspeedup against serial ({group}; medians, interval from both 95 % intervals)");
    println!("{:<16} {:>7} {:>9}   interval", "strategy", "threads", "speedup");
    for ((strategy, threads), [speedup, low, high]) in rows {
        println!("{strategy:<16} {threads:>7} {speedup:>9.3}   {low:.3} to {high:.3}");
    }
}

fn stored() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    std::env::var_os("CRITERION_HOME").map_or_else(|| target.join("criterion"), PathBuf::from)
}

fn collect(folder: &Path, start: SystemTime, cases: &mut Vec<Case>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.ends_with("new") {
            let stored = std::fs::metadata(path.join("estimates.json")).and_then(|data| data.modified());
            if stored.is_ok_and(|stored| stored >= start) {
                cases.extend(case(&path));
            }
        } else if path.is_dir() {
            collect(&path, start, cases);
        }
    }
}

fn case(folder: &Path) -> Option<Case> {
    let read = |name: &str| -> Option<serde_json::Value> {
        serde_json::from_str(&std::fs::read_to_string(folder.join(name)).ok()?).ok()
    };
    let (benchmark, estimates) = (read("benchmark.json")?, read("estimates.json")?);
    let median = estimates.get("median")?;
    let interval = median.get("confidence_interval")?;
    let seconds = |value: Option<&serde_json::Value>| Some(value?.as_f64()? * 1e-9);
    Some(Case {
        strategy: benchmark.get("function_id")?.as_str()?.to_string(),
        threads: benchmark.get("value_str")?.as_str()?.to_string(),
        median_s: [
            seconds(median.get("point_estimate"))?,
            seconds(interval.get("lower_bound"))?,
            seconds(interval.get("upper_bound"))?,
        ],
    })
}
