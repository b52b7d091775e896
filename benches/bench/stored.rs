//! The medians that criterion has just stored. Criterion calls its files a private detail, so they are read only here;
//! missing or unreadable files are left out.

use super::BenchRow;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Returns the folder of criterion's files.
fn folder() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    std::env::var_os("CRITERION_HOME").map_or_else(|| target.join("criterion"), PathBuf::from)
}

/// Returns the cases stored since `start`, sorted by group, case and parameter.
pub(super) fn since(start: SystemTime) -> Vec<BenchRow> {
    let mut rows = Vec::new();
    collect(&folder(), start, &mut rows);
    let order = |row: &BenchRow| (row.group.clone(), row.case.clone(), row.parameter.parse::<u64>().ok());
    rows.sort_by(|a, b| order(a).cmp(&order(b)).then_with(|| a.parameter.cmp(&b.parameter)));
    rows
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
    // The value is null for a case without a parameter.
    let text = |name: &str| Some(benchmark.get(name)?.as_str().unwrap_or_default().to_string());
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
