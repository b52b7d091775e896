//! The table that `cargo bench` ends with: speedups against `serial`, from the medians that criterion has just stored. With
//! `PATHMARK_BENCH_OUT=DIR` all cases are also written into that folder of results, where `pathmark report DIR` finds them.
//!
//! Criterion calls its files a private detail, so this is the only place that reads them; what is missing or unreadable is left out.

use pathmark::measure::Machine;
use pathmark::report::{BenchRow, write_benches};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Prints the table of a group from what was stored since `start`, unless there is nothing to print, as under `cargo bench -- --test`.
pub(crate) fn print(group: &str, start: SystemTime) {
    let mut rows = Vec::new();
    collect(&stored(), start, &mut rows);
    rows.sort_by(|a, b| (&a.group, &a.case, &a.parameter).cmp(&(&b.group, &b.case, &b.parameter)));
    if let Some(out) = std::env::var_os("PATHMARK_BENCH_OUT").filter(|_| !rows.is_empty()) {
        let command = std::iter::once("cargo bench --bench scheduling".to_string());
        let filter: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
        let command: Vec<String> =
            command.chain((!filter.is_empty()).then(|| format!("-- {}", filter.join(" ")))).collect();
        if let Err(error) = write_benches(Path::new(&out), command.join(" "), &rows) {
            eprintln!("{error}");
        }
    }
    let own = || rows.iter().filter(|row| row.group == group);
    let Some(serial) = own().find(|row| row.case == "serial") else { return };
    let mut speedups: Vec<(&BenchRow, [f64; 3])> = own().map(|row| (row, row.speedup_over(serial))).collect();
    speedups.sort_by(|a, b| b.1[0].total_cmp(&a.1[0]));
    println!("\nspeedup against serial ({group}; medians, interval from both 95 % intervals)");
    println!("{:<16} {:>7} {:>9}   interval", "strategy", "threads", "speedup");
    for (row, [speedup, low, high]) in speedups {
        println!("{:<16} {:>7} {speedup:>9.3}   {low:.3} to {high:.3}", row.case, row.parameter);
    }
    println!("\n{}. Cases ran one after the other, so a drift of the machine is in the table;", Machine::look().line());
    println!("`pathmark run thread-scaling` interleaves them and tells which runs were disturbed.");
}

fn stored() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    std::env::var_os("CRITERION_HOME").map_or_else(|| target.join("criterion"), PathBuf::from)
}

fn collect(folder: &Path, start: SystemTime, rows: &mut Vec<BenchRow>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.ends_with("new") {
            let stored = std::fs::metadata(path.join("estimates.json")).and_then(|data| data.modified());
            if stored.is_ok_and(|stored| stored >= start) {
                rows.extend(case(&path));
            }
        } else if path.is_dir() {
            collect(&path, start, rows);
        }
    }
}

fn case(folder: &Path) -> Option<BenchRow> {
    let read = |name: &str| -> Option<serde_json::Value> {
        serde_json::from_str(&std::fs::read_to_string(folder.join(name)).ok()?).ok()
    };
    let (benchmark, estimates) = (read("benchmark.json")?, read("estimates.json")?);
    let median = estimates.get("median")?;
    let interval = median.get("confidence_interval")?;
    let seconds = |value: Option<&serde_json::Value>| Some(value?.as_f64()? * 1e-9);
    let text = |name: &str| Some(benchmark.get(name)?.as_str()?.to_string());
    Some(BenchRow {
        group: text("group_id")?,
        case: text("function_id")?,
        parameter: text("value_str")?,
        elements: benchmark.get("throughput")?.get("Elements")?.as_u64()?,
        median_s: seconds(median.get("point_estimate"))?,
        low_s: seconds(interval.get("lower_bound"))?,
        high_s: seconds(interval.get("upper_bound"))?,
    })
}
