//! Short parallel regions with gaps: `bursts/bursts.csv`, which `reproduce` and `pathmark bursts --out` write.

use crate::analysis::adjacent_pairs::FEWEST_PROCESSES;
use crate::bursts::{FILE, FOLDER, Line, are_in, lines, strategies, usual_yardstick, verdict};
use crate::csv_file;
use crate::error::Error;
use crate::experiment::{Chapter, MACHINE, read_run_file};
use crate::measure::BurstRow;
use crate::page::Section;
use crate::plot::number::short;
use crate::prelude::*;
use std::path::Path;

const QUESTION: &str = "May idle workers spin, or should they sleep, if a program is parallel only in short regions?";

const ANALYSIS: &str = "The caller sleeps between two regions, so every region finds its workers waiting. Workers that sleep must be woken; workers that spin keep processors busy while nobody has work. \
Spinning pays if a strategy wakes faster, its regions take less time, and nobody else needs the processors that it keeps busy in the gaps.\n\n\
The wake latency is the time from the hand-over of a region to its first job on another thread than the caller's. A caller that works, too, may finish first; the region then counts with its whole length. \
The strategies take turns in alternating order. A ratio compares two turns of one round, and its interval follows from several processes.";

/// The section, if a folder has bursts.
pub(crate) fn section(out: &Path) -> Result<Option<Section>> {
    if !are_in(out) {
        return Ok(None);
    }
    let folder = out.join(FOLDER);
    let path = folder.join(FILE);
    let rows: Vec<BurstRow> = csv_file::read(&path)?;
    let strategies = strategies(&rows);
    let Some(yardstick) = usual_yardstick(&strategies) else { return Ok(None) };
    let lines = lines(&rows, yardstick).map_err(|error| match error {
        Error::Input(error) => error.in_file(path.display().to_string(), None).into(),
        other => other,
    })?;
    let run = read_run_file(&folder.join(MACHINE))?;
    let processes = rows.iter().map(|row| row.process).collect::<BTreeSet<_>>().len();
    let mut blocks = Vec::new();
    if processes < FEWEST_PROCESSES {
        blocks.push(Block::notice("The ratios have no intervals: these rows come from fewer than 3 processes."));
    } else {
        blocks.extend(lines.chunk_by(|a, b| a.gap_s == b.gap_s).map(|own| Block::finding(verdict(own, yardstick))));
    }
    blocks.push(Block::figure("wakes", plot(&lines, &strategies, yardstick, run.machine.line())));
    blocks.push(table(&lines, yardstick));
    Ok(Some(Section {
        name: FOLDER.to_string(),
        title: "Does spinning pay?".to_string(),
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

/// Microseconds of a gap.
fn us(gap_s: f64) -> String {
    format!("{} us", short(1e6 * gap_s, 4))
}

/// A row for each strategy but the yardstick, with a dot for each gap; the one that wakes fastest at the top.
fn plot(lines: &[Line], strategies: &[String], yardstick: &str, machine: String) -> DotPlot {
    let gaps: Vec<&[Line]> = lines.chunk_by(|a, b| a.gap_s == b.gap_s).collect();
    let ratio = |gap: &&[Line], name: &str| gap.iter().find(|line| line.strategy == name)?.wake_ratio;
    let row = |name: &String| {
        let ratios: Vec<Option<Estimated>> = gaps.iter().map(|gap| ratio(gap, name)).collect();
        let middle = median(&ratios.iter().flatten().map(|ratio| ratio.value).collect::<Vec<_>>())?;
        let dots = ratios.into_iter().map(|ratio| ratio.map(|ratio| ratio.dot())).collect();
        Some((middle, DotRow::new(name, dots)))
    };
    let mut rows: Vec<(f64, DotRow)> = strategies.iter().filter_map(row).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let axis = Axis::log(format!("wake latency / wake latency of {yardstick}"));
    let title = format!("Wake latency of each strategy, compared with {yardstick}");
    let mut plot = DotPlot::new(
        Title::new(title).with_result(result(lines, yardstick)),
        axis,
        rows.into_iter().map(|(_, row)| row).collect(),
    )
    .grouped(gaps.iter().map(|gap| format!("gap of {}", us(gap[0].gap_s))));
    plot.subtitle = machine;
    plot.caption = format!(
        "Left of the line a strategy wakes faster than {yardstick}, in the same round. Bars: 95 % interval over processes."
    );
    plot.guides = vec![(1.0, yardstick.to_string())];
    plot
}

/// The result in a line: the strategy that certainly wakes fastest, and after which gap.
fn result(lines: &[Line], yardstick: &str) -> Option<String> {
    let told = lines.iter().filter_map(|line| Some((line, line.wake_ratio?)));
    let known: Vec<(&Line, Estimated)> = told.filter(|(_, ratio)| ratio.interval.is_some()).collect();
    if known.is_empty() {
        return None;
    }
    let faster = known.into_iter().filter(|(_, ratio)| ratio.interval.is_some_and(|interval| interval.high < 1.0));
    let fastest = faster.min_by(|a, b| a.1.value.total_cmp(&b.1.value));
    Some(fastest.map_or_else(
        || format!("No strategy wakes faster than {yardstick} beyond the noise"),
        |(line, ratio)| {
            let less = titles::percent(1.0 - ratio.value);
            format!("After gaps of {}, {} wakes {less} sooner than {yardstick}", us(line.gap_s), line.strategy)
        },
    ))
}

fn table(lines: &[Line], yardstick: &str) -> Block {
    Block::table("bursts", format!("Strategies after each gap, ratios to {yardstick}"), lines)
        .column("strategy", |line| line.strategy.clone())
        .column("gap", |line| us(line.gap_s))
        .number("wake median, us", Significant(3), |line| 1e6 * line.wake_s)
        .number("wake 95th percentile, us", Significant(3), |line| 1e6 * line.wake_p95_s)
        .estimated("ratio of wakes", Decimals(2), |line| line.wake_ratio)
        .number("region, us", Significant(3), |line| 1e6 * line.region_s)
        .estimated("ratio of regions", Decimals(2), |line| line.region_ratio)
        .number("processors busy in gaps", Decimals(2), |line| line.idle_processors)
        .number("threads started in a region", Significant(3), |line| line.started)
        .end()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::RunFile;

    /// Wakes of three strategies, in processes of two rounds: `half` always has half of rayon's, and `double` twice as
    /// long ones, give or take a factor that differs between processes. Round 1 is three times as slow for all.
    fn rows(processes: u32) -> Vec<BurstRow> {
        let places = (0..processes).flat_map(|process| [0, 1].map(|round| (process, round)));
        let row = |(process, round): (u32, u32), (name, factor): (&str, f64)| {
            let us = 1e-6 * factor * if round == 0 { 1.0 } else { 3.0 };
            BurstRow {
                process,
                round,
                place: 0,
                strategy: name.to_string(),
                threads: 2,
                regions: 5,
                jobs: 4,
                job_s: 1e-6,
                gap_s: 2e-5,
                slept_s: 3e-5,
                wake_s: us,
                wake_p95_s: 2.0 * us,
                region_s: 10.0 * us,
                idle_processors: Some(factor),
                started: 0.0,
            }
        };
        let spread = |process: u32| [0.5, 1.0, 2.0][process as usize % 3];
        let of = |at: (u32, u32)| [("half", 0.5), ("rayon", 1.0), ("double", 2.0 * spread(at.0))].map(|of| row(at, of));
        places.flat_map(of).collect()
    }

    fn section_of(rows: &[BurstRow]) -> (tempfile::TempDir, Result<Option<Section>>) {
        let out = tempfile::tempdir().unwrap();
        let folder = out.path().join(FOLDER);
        std::fs::create_dir(&folder).unwrap();
        RunFile::of_now("pathmark bursts".to_string()).write(&folder.join(MACHINE)).unwrap();
        csv_file::write(&folder.join(FILE), rows).unwrap();
        let section = section(out.path());
        (out, section)
    }

    fn cells(section: &Section) -> Vec<Vec<String>> {
        let tables = section.blocks.iter().filter_map(|block| match block {
            Block::Table { table, .. } => Some(table.rows().collect::<Vec<_>>()),
            _ => None,
        });
        tables.flatten().collect()
    }

    /// Logarithms -1, 0 and 1 in units of ln 2 have the standard error 1 / sqrt(3); Student's t with two degrees of freedom
    /// is 4.30265, so the ends are 2 / 5.595 and 2 * 5.595. Equal ratios have no spread and therefore no interval.
    #[test]
    fn ratios_are_of_the_same_round() {
        let (_out, section) = section_of(&rows(3));
        let section = section.unwrap().unwrap();
        let cells = cells(&section);
        assert_eq!(cells[0], ["half", "20 us", "1", "2", "0.50, no interval", "10", "0.50, no interval", "0.50", "0"]);
        assert_eq!(cells[1][..5], ["rayon", "20 us", "2", "4", "-"]);
        assert_eq!(cells[2][4], "2.00, 0.36 to 11.19");
        let told = section.blocks[0].as_finding().unwrap();
        assert_eq!(told, "After gaps of 20 us, no strategy wakes faster than rayon beyond the noise.");
    }

    #[test]
    fn the_fastest_is_at_the_top() {
        let lines = lines(&rows(3), "rayon").unwrap();
        let names = ["double", "half", "rayon"].map(str::to_string);
        let plot = plot(&lines, &names, "rayon", String::new());
        let of = |row: &DotRow| (row.name.clone(), row.dots[0].unwrap().value);
        let shown: Vec<(String, f64)> = plot.rows.iter().map(of).collect();
        assert_eq!(shown[0], ("half".to_string(), 0.5));
        assert!(shown[1].0 == "double" && (shown[1].1 - 2.0).abs() < 1e-12 && shown.len() == 2, "{shown:?}");
    }

    #[test]
    fn few_processes_have_no_intervals() {
        let (_out, section) = section_of(&rows(2));
        let section = section.unwrap().unwrap();
        assert!(matches!(&section.blocks[0], Block::Notice(text) if text.contains("fewer than 3 processes")));
        assert!(cells(&section).iter().all(|row| row[4] == "-" || row[4].ends_with(", no interval")));
    }

    #[test]
    fn damaged_rows_are_told_with_their_place() {
        assert!(section(tempfile::tempdir().unwrap().path()).unwrap().is_none());
        assert!(section_of(&[]).1.unwrap().is_none());
        let (out, _) = section_of(&rows(3));
        let path = out.path().join(FOLDER).join(FILE);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replacen("half,2,5", "half,two,5", 1)).unwrap();
        let error = section(out.path()).err().unwrap();
        assert!(error.exit_code() == 2 && error.to_string().contains("bursts.csv:2"), "{error}");
        let twice = section_of(&[rows(3), rows(1)].concat()).1.err().unwrap();
        let told = "bursts.csv: process, round = 0, 0: rayon has two rows for a gap of 0.00002 s in one round";
        assert!(twice.exit_code() == 2 && twice.to_string().contains(told), "{twice}");
    }
}
