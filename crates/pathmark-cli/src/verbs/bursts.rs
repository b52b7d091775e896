//! `pathmark bursts`: many short parallel regions with gaps. Does it pay to let idle workers spin?
//!
//! All pools take turns, in alternating order, within a process; a ratio compares two turns of one round, and its interval
//! follows from several processes, each of which is this program started again.

use super::prelude::*;
use super::selftest::write_machine;
use crate::experiment::{MACHINE, read_run_file};
use crate::measure::{BurstRow, Bursts, Spin, available_threads, keeps_threads, run_bursts};
use crate::report::Estimated;
use crate::report::bursts::{FILE, FOLDER, Line, in_words, lines, usual_yardstick, verdict};
use clap::{Parser, value_parser};
use std::num::NonZeroUsize;
use std::process::{Command, Stdio};
use std::time::Duration;

/// A strategy whose threads start in each region, beside the pools.
const WITHOUT_POOL: &str = "shared-counter";
/// The longest job and gap.
const LONGEST: Duration = Duration::from_secs(1);

/// `pathmark bursts --gap 20us,2ms --strategy rayon,fixed-pool`
#[derive(Parser)]
pub(crate) struct Arguments {
    /// Strategies of `pathmark list strategies` [default: all that keep their threads, and shared-counter, which starts them
    /// in each region]
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    strategy: Vec<String>,
    /// Compare all others with this one [default: rayon, if it takes part, or the first]
    #[arg(long, value_name = "NAME")]
    with: Option<String>,
    /// Time that the caller sleeps before each region
    #[arg(long, value_name = "TIME,..", value_delimiter = ',', default_value = "20us,200us,2ms", value_parser = length, allow_hyphen_values = true)]
    gap: Vec<Duration>,
    /// Jobs of a region
    #[arg(long, value_name = "J", default_value_t = 8, value_parser = value_parser!(u32).range(1..=1_000_000))]
    jobs: u32,
    /// Length of a job
    #[arg(long, value_name = "TIME", default_value = "5us", value_parser = length, allow_hyphen_values = true)]
    job: Duration,
    /// Workers [default: one per processor]
    #[arg(long, value_name = "T", value_parser = value_parser!(u16).range(1..=16_384))]
    threads: Option<u16>,
    /// Regions of a turn
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = value_parser!(u32).range(1..=1_000_000))]
    regions: u32,
    /// Turns of each pool in a process
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = value_parser!(u32).range(1..=10_000))]
    rounds: u32,
    /// Processes; intervals need 3
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = value_parser!(u32).range(1..=10_000))]
    processes: u32,
    /// Folder for the rows of all turns and the machine. `pathmark report DIR` shows those in DIR/bursts
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print an array of JSON objects
    #[arg(long)]
    json: bool,
    /// The number of this process, which measures and prints its rows
    #[arg(long, hide = true)]
    process: Option<u32>,
}

fn length(text: &str) -> std::result::Result<Duration, String> {
    let allowed = || format!("is not a time from 0s to {LONGEST:?}, such as 100us");
    humantime::parse_duration(text).ok().filter(|length| *length <= LONGEST).ok_or_else(allowed)
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    let threads = threads(arguments);
    let strategies = strategies(arguments, lab, threads)?;
    if let Some(process) = arguments.process {
        return print_json(&turns(arguments, lab, threads, &strategies, process)?);
    }
    let yardstick = yardstick(arguments, &strategies)?;
    if let Some(out) = &arguments.out {
        create_folder("out", out)?;
        claim(out, &mut Files::default())?;
    }
    let rows = measure(arguments, threads, &strategies, console)?;
    if let Some(out) = &arguments.out {
        write(out, lab, &rows)?;
    }
    let lines = lines(&rows, yardstick)?;
    if arguments.json {
        return print_json(&lines);
    }
    for own in lines.chunk_by(|a, b| a.gap_s == b.gap_s) {
        print(&table(own, yardstick, &rows[0]))?;
    }
    if arguments.processes < 3 {
        console.note("intervals need 3 processes (--processes 3)");
    }
    Ok(())
}

/// Measures as `pathmark bursts --out OUT/bursts` does.
pub(super) fn measure_into(out: &Path, lab: &Lab, console: &Console) -> Result<()> {
    let defaults = Arguments::parse_from(["bursts"]);
    let threads = threads(&defaults);
    let rows = measure(&defaults, threads, &strategies(&defaults, lab, threads)?, console)?;
    write(&out.join(FOLDER), lab, &rows)
}

/// Adds the rows and the machine to the files that a command will write. Refuses a folder that has rows: measurements are
/// never overwritten.
pub(super) fn claim(folder: &Path, files: &mut Files) -> Result<()> {
    files.renews("out", &folder.join(FILE), |_| false)?;
    files.renews("out", &folder.join(MACHINE), |path| read_run_file(path).is_ok())
}

fn write(folder: &Path, lab: &Lab, rows: &[BurstRow]) -> Result<()> {
    write_machine(folder, lab)?;
    crate::csv_file::write(&folder.join(FILE), rows)
}

fn threads(arguments: &Arguments) -> NonZeroUsize {
    let threads = arguments.threads.map_or_else(available_threads, usize::from);
    NonZeroUsize::new(threads).unwrap_or(NonZeroUsize::MIN)
}

/// The rows of all processes.
fn measure(
    arguments: &Arguments,
    threads: NonZeroUsize,
    strategies: &[String],
    console: &Console,
) -> Result<Vec<BurstRow>> {
    console.begin("bursts", u64::from(arguments.processes));
    let mut rows = Vec::new();
    for process in 0..arguments.processes {
        rows.extend(in_process(arguments, threads, strategies, process)?);
        console.advance(u64::from(process) + 1);
    }
    console.end();
    Ok(rows)
}

/// The strategies that take part, each once.
fn strategies(arguments: &Arguments, lab: &Lab, threads: NonZeroUsize) -> Result<Vec<String>> {
    let mut found: Vec<String> = Vec::new();
    for name in &arguments.strategy {
        lab.strategy_named(name)?;
        if !found.contains(name) {
            found.push(name.clone());
        }
    }
    if found.is_empty() {
        for entry in lab.strategies() {
            if entry.name == WITHOUT_POOL || keeps_threads(lab, entry.name, threads)? {
                found.push(entry.name.to_string());
            }
        }
    }
    Ok(found)
}

fn yardstick<'a>(arguments: &'a Arguments, strategies: &'a [String]) -> Result<&'a str> {
    match &arguments.with {
        Some(name) if !strategies.contains(name) => {
            Err(InputError::new("with", name, "does not take part").allowed(strategies.join(", ")).into())
        }
        Some(name) => Ok(name),
        None => Ok(usual_yardstick(strategies).unwrap_or_default()),
    }
}

/// The turns of a process: each gap and round, with the strategies in alternating order.
fn turns(
    arguments: &Arguments,
    lab: &Lab,
    threads: NonZeroUsize,
    strategies: &[String],
    process: u32,
) -> Result<Vec<BurstRow>> {
    let work = Spin::calibrate();
    let mut rows = Vec::new();
    for round in 0..arguments.rounds {
        for gap in &arguments.gap {
            let Arguments { regions, job, .. } = *arguments;
            let bursts = Bursts { threads, regions, jobs: arguments.jobs as usize, job, gap: *gap };
            let mut names: Vec<&String> = strategies.iter().collect();
            if (process + round) % 2 == 1 {
                names.reverse();
            }
            for (place, name) in (0..).zip(names) {
                rows.push(BurstRow { process, round, place, ..run_bursts(lab, name, work, bursts)? });
            }
        }
    }
    Ok(rows)
}

/// Measures in a process of its own.
fn in_process(
    arguments: &Arguments,
    threads: NonZeroUsize,
    strategies: &[String],
    process: u32,
) -> Result<Vec<BurstRow>> {
    let own = std::env::current_exe().map_err(|e| Error::system("finding", "this program", e))?;
    let time = |length: &Duration| humantime::format_duration(*length).to_string().replace(' ', "");
    let gaps: Vec<String> = arguments.gap.iter().map(time).collect();
    let options = [
        ("--strategy", strategies.join(",")),
        ("--gap", gaps.join(",")),
        ("--jobs", arguments.jobs.to_string()),
        ("--job", time(&arguments.job)),
        ("--threads", threads.to_string()),
        ("--regions", arguments.regions.to_string()),
        ("--rounds", arguments.rounds.to_string()),
        ("--process", process.to_string()),
    ];
    let mut command = Command::new(own);
    command.arg("bursts").args(options.iter().flat_map(|(name, value)| [*name, value]));
    let output = command.stdin(Stdio::null()).output().map_err(|e| Error::system("running", "this program", e))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).trim().to_string();
        let error = std::io::Error::other(format!("{}: {said}", output.status));
        return Err(Error::system("running", "a process of bursts", error));
    }
    serde_json::from_slice(&output.stdout).map_err(|e| Error::system("reading", "the rows of a process", e.into()))
}

fn table(lines: &[Line], yardstick: &str, row: &BurstRow) -> String {
    let gap = humantime::format_duration(Duration::from_secs_f64(lines[0].gap_s));
    let head = format!(
        "gap {gap}, {} of {:.1} us, {}; times in us, ratios to {yardstick} with 95 % intervals",
        counted(row.jobs, "job"),
        1e6 * row.job_s,
        counted(row.threads, "thread")
    );
    let names = format!(
        "{:>8} {:>8} {:>24} {:>9} {:>6} {:>24} {:>10} {:>8}  strategy",
        "wake", "p95", "ratio", "region", "ideal", "ratio", "processors", "threads"
    );
    let under = format!(
        "{:>8} {:>8} {:>24} {:>9} {:>6} {:>24} {:>10} {:>8}",
        "", "", "of wakes", "", "share", "of regions", "in gaps", "started"
    );
    let ratio = |ratio: &Option<Estimated>| ratio.as_ref().map_or_else(|| "-".to_string(), in_words);
    let line = |line: &Line| {
        let idle = line.idle_processors.map_or_else(|| "-".to_string(), |idle| format!("{idle:.2}"));
        let (wakes, regions) = (ratio(&line.wake_ratio), ratio(&line.region_ratio));
        let share = line.ideal_s / line.region_s;
        format!(
            "{:>8.1} {:>8.1} {wakes:>24} {:>9.1} {share:>6.2} {regions:>24} {idle:>10} {:>8.1}  {}",
            1e6 * line.wake_s,
            1e6 * line.wake_p95_s,
            1e6 * line.region_s,
            line.started,
            line.strategy,
        )
    };
    let body = lines.iter().map(line);
    [head, names, under.trim_end().to_string()]
        .into_iter()
        .chain(body)
        .chain([verdict(lines, yardstick), String::new()])
        .collect::<Vec<_>>()
        .join("\n")
}
