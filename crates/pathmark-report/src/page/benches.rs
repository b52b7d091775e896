//! Results of `cargo bench --bench scheduling`: it writes `benches/benches.csv` into the folder that
//! `PATHMARK_BENCH_OUT` names.

use crate::csv_file;
use crate::error::Error;
use crate::experiment::{Chapter, MACHINE, RunFile, read_run_file};
use crate::page::Section;
use crate::plot::Dot;
use crate::prelude::*;
use serde::Serialize;
use std::path::Path;

/// Name of the file's folder within the results.
const FOLDER: &str = "benches";
const FILE: &str = "benches.csv";

const QUESTION: &str =
    "What does `cargo bench` say of the strategies, and what does the interface between scheduling and work cost?";

const ANALYSIS: &str = "Each run of a strategy stands beside a serial run of the same jobs, in alternating order and in several processes; its speedup is the ratio within these pairs, and its interval is over processes. \
Times are criterion's, which measures its cases one after the other, so a drift of the machine's speed falls on some of them and not on others.\n\n\
The seam sets strategies beside their bare mechanisms, both with empty jobs: the difference is what the interface costs.";

/// One case as criterion measured it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BenchRow {
    /// Criterion's group: `scheduling`, `empty-jobs`, `seam` or `trace`.
    pub group: String,
    /// The case: in most groups a strategy.
    pub case: String,
    /// Its parameter: in most groups the threads.
    pub parameter: String,
    /// Samples or jobs of a round.
    pub elements: u64,
    /// Median seconds of a round.
    pub median_s: f64,
    /// Lower end of its 95 % interval.
    pub low_s: f64,
    pub high_s: f64,
    /// Speedup over serial runs in adjacent pairs; empty for cases that are not compared.
    #[serde(default)]
    pub speedup: Option<f64>,
    /// Ends of its 95 % interval over processes.
    #[serde(default)]
    pub speedup_low: Option<f64>,
    #[serde(default)]
    pub speedup_high: Option<f64>,
}

/// Writes the cases and a description of the machine into a folder of results.
pub fn write_benches(out: &Path, command: String, rows: &[BenchRow]) -> Result<()> {
    let folder = out.join(FOLDER);
    std::fs::create_dir_all(&folder).map_err(|e| Error::system("making", &folder, e))?;
    RunFile::of_now(command).write(&folder.join(MACHINE))?;
    csv_file::write(&folder.join(FILE), rows)
}

/// The section, if a folder has such a file.
pub(crate) fn section(out: &Path) -> Result<Option<Section>> {
    let folder = out.join(FOLDER);
    let path = folder.join(FILE);
    if !path.is_file() {
        return Ok(None);
    }
    let rows: Vec<BenchRow> = csv_file::read(&path)?;
    let run = read_run_file(&folder.join(MACHINE))?;
    let speedups = speedups(&rows);
    let mut blocks = Vec::new();
    if !speedups.is_empty() {
        blocks.push(Block::figure("speedup", plot(&speedups, run.machine.line())));
        blocks.push(speedup_table(&speedups));
    }
    let seam = pairs(&rows);
    if !seam.is_empty() {
        blocks.push(seam_table(&seam));
    }
    blocks.push(all(&rows));
    Ok(Some(Section {
        name: FOLDER.to_string(),
        title: "What cargo bench measured".to_string(),
        question: QUESTION.to_string(),
        analysis: ANALYSIS.to_string(),
        chapter: Some(Chapter::Scheduling),
        place: u32::MAX,
        rows: rows.len(),
        run: Some(run),
        files: vec![format!("{FOLDER}/{FILE}")],
        blocks,
        ..Section::default()
    }))
}

/// The cases that were compared with serial runs, fastest first.
fn speedups(rows: &[BenchRow]) -> Vec<(&BenchRow, [f64; 3])> {
    let speedup = |row: &BenchRow| Some([row.speedup?, row.speedup_low?, row.speedup_high?]);
    let mut found: Vec<_> = rows.iter().filter_map(|row| Some((row, speedup(row)?))).collect();
    found.sort_by(|a, b| b.1[0].total_cmp(&a.1[0]));
    found
}

/// Pairs each strategy with its bare mechanism on the same number of threads.
fn pairs(rows: &[BenchRow]) -> Vec<(&BenchRow, &BenchRow)> {
    let own = || rows.iter().filter(|row| row.group == "seam");
    let bare: BTreeMap<_, _> =
        own().filter_map(|row| Some(((row.case.strip_suffix("-bare")?, row.parameter.as_str()), row))).collect();
    own().filter_map(|row| Some((row, *bare.get(&(row.case.as_str(), row.parameter.as_str()))?))).collect()
}

fn plot(speedups: &[(&BenchRow, [f64; 3])], machine: String) -> DotPlot {
    let row = |(row, [speedup, low, high]): &(&BenchRow, [f64; 3])| {
        let dot = Dot::new(*speedup, Some((*low, *high)));
        DotRow::new(format!("{}, {}", row.case, row.parameter), vec![Some(dot)])
    };
    let result = speedups.first().and_then(|(row, [value, low, high])| {
        let interval = Interval { low: *low, high: *high, level: LEVEL };
        let times = titles::told(Estimated::of(*value, Some(interval)))?;
        let crew = row.parameter.parse().map_or_else(|_| row.parameter.clone(), |threads| counted(threads, "thread"));
        Some(format!("{} on {crew} is {times} times as fast as serial", row.case))
    });
    let mut plot = DotPlot::new(
        Title::new("Speedup by cargo bench").with_result(result),
        Axis::linear("times as fast as serial").including([1.0]),
        speedups.iter().map(row).collect(),
    );
    plot.subtitle = machine;
    plot.caption = "Names: strategy, threads. Bars: 95 % intervals over processes.".to_string();
    plot.guides = vec![(1.0, "serial".to_string())];
    plot
}

fn speedup_table(speedups: &[(&BenchRow, [f64; 3])]) -> Block {
    Block::table("speedup", "Speedup against serial", speedups)
        .column("strategy", |(row, _)| row.case.clone())
        .column("threads", |(row, _)| row.parameter.clone())
        .number("speedup", Decimals(3), |(_, [speedup, ..])| *speedup)
        .number("low", Decimals(3), |(_, [_, low, _])| *low)
        .number("high", Decimals(3), |(_, [.., high])| *high)
        .end()
}

fn seam_table(pairs: &[(&BenchRow, &BenchRow)]) -> Block {
    let ns = |seconds: f64, row: &BenchRow| 1e9 * seconds / row.elements as f64;
    Block::table("seam", "What the seam between scheduling and work costs", pairs)
        .column("strategy", |(own, _)| own.case.clone())
        .column("threads", |(own, _)| own.parameter.clone())
        .number("bare mechanism, ns a job", Decimals(1), |(_, bare)| ns(bare.median_s, bare))
        .number("strategy, ns a job", Decimals(1), |(own, _)| ns(own.median_s, own))
        .number("difference, ns", Decimals(1), |(own, bare)| ns(own.median_s - bare.median_s, own))
        .number("low", Decimals(1), |(own, bare)| ns(own.low_s - bare.high_s, own))
        .number("high", Decimals(1), |(own, bare)| ns(own.high_s - bare.low_s, own))
        .end()
}

fn all(rows: &[BenchRow]) -> Block {
    Block::table("rounds", "All cases, intervals of 95 %", rows)
        .column("group", |row| row.group.clone())
        .column("case", |row| row.case.clone())
        .column("threads or pieces", |row| row.parameter.clone())
        .column("samples or jobs", |row| row.elements.to_string())
        .number("median of a round, us", Decimals(2), |row| 1e6 * row.median_s)
        .number("low", Decimals(2), |row| 1e6 * row.low_s)
        .number("high", Decimals(2), |row| 1e6 * row.high_s)
        .end()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(group: &str, case: &str, parameter: &str, median_s: f64) -> BenchRow {
        BenchRow {
            group: group.to_string(),
            case: case.to_string(),
            parameter: parameter.to_string(),
            elements: 1000,
            median_s,
            low_s: 0.9 * median_s,
            high_s: 1.1 * median_s,
            speedup: None,
            speedup_low: None,
            speedup_high: None,
        }
    }

    #[test]
    fn written_rows_are_read_and_compared() {
        let folder = tempfile::tempdir().unwrap();
        let rows = [
            row("scheduling", "serial", "1", 2.0),
            BenchRow {
                speedup: Some(1.9),
                speedup_low: Some(1.8),
                speedup_high: Some(2.0),
                ..row("scheduling", "rayon", "2", 1.0)
            },
            row("seam", "rayon", "2", 3e-6),
            row("seam", "rayon-bare", "2", 2e-6),
        ];
        write_benches(folder.path(), "cargo bench".to_string(), &rows).unwrap();
        assert_eq!(csv_file::read::<BenchRow>(&folder.path().join(FOLDER).join(FILE)).unwrap(), rows);
        let found = speedups(&rows);
        assert_eq!(found, [(&rows[1], [1.9, 1.8, 2.0])]);
        let seam = seam_table(&pairs(&rows));
        // 1 us more for 1000 jobs is 1 ns per job; the interval is from 2.7 - 2.2 to 3.3 - 1.8.
        let Block::Table { table: seam, .. } = seam else { panic!("a table") };
        assert_eq!(seam.rows().collect::<Vec<_>>(), [["rayon", "2", "2.0", "3.0", "1.0", "0.5", "1.5"]]);
        assert!(section(folder.path()).unwrap().is_some());
        assert!(section(&folder.path().join("none")).unwrap().is_none());
    }
}
