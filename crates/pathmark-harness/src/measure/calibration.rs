//! Calibration: the cost of a strategy's mechanism on this machine, from timed empty jobs.
//!
//! With empty jobs, a run's time is the mechanism's alone. Each strategy runs two numbers of empty jobs on 1, 2, 4 and
//! so on threads, up to all that this process may use. As in a measured run (`Setup::run`), the strategy is made anew
//! before the clock starts, so a pool's workers may still be starting when the jobs come. All strategies take turns.
//! Each row is the median of [`ROUNDS`] rounds, or of as many as fit into [`BUDGET`]; a first round is discarded.
//!
//! A calibration is repeated: a sweep makes half of the [`CALIBRATIONS`] before its first cell and half after its last
//! one. The costs differ from one calibration to the next, and the forecasts' intervals contain this difference.
//!
//! The simulator interprets the rows (`simulate::Overheads`).

use super::available_threads;
use super::usage::Usage;
use crate::analysis::quantile::median;
use crate::csv_file;
use crate::error::{Error, InputError, Result};
use crate::lab::Lab;
use crate::strategy::{Config, Spawner, SystemThreads, Workers};
use serde::{Deserialize, Serialize};
use std::borrow::Borrow;
use std::hint::black_box;
use std::io;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Most rounds that count towards the median.
const ROUNDS: usize = 9;
/// No round begins after this time; at least three count.
const BUDGET: Duration = Duration::from_millis(400);
/// Calibrations of a sweep: with eight, the quantile of Student's t is 2.4; with three, it would be 4.3.
pub const CALIBRATIONS: u32 = 8;
/// Jobs of a run: few, for the cost of a run, and many, for the cost of a job.
const JOBS: [usize; 2] = [200, 20_000];
/// The same if each job is a thread.
const JOBS_WITH_THREADS: [usize; 2] = [16, 112];

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CalibrationRow {
    pub strategy: String,
    /// Requested threads; 1 where that has no meaning.
    pub threads: usize,
    pub jobs: usize,
    pub seconds: f64,
    /// CPU seconds that this process used meanwhile, on all processors; empty if the system does not report them.
    pub cpu_s: Option<f64>,
    /// Threads that the strategy started during the run; 0 for pools.
    pub started: usize,
    /// The calibration that the row belongs to, from 0. Older files have one calibration and no such column.
    #[serde(default)]
    pub calibration: u32,
}

#[cfg(test)]
impl CalibrationRow {
    /// A run in which each thread takes so long to start and the jobs take no time.
    pub(crate) fn of_starts(strategy: &str, threads: usize, start_s: f64) -> Self {
        let (strategy, seconds) = (strategy.to_string(), start_s * threads as f64);
        Self { strategy, threads, jobs: 200, seconds, cpu_s: None, started: threads, calibration: 0 }
    }
}

#[derive(Default)]
pub(super) struct Counted(AtomicUsize);

impl Counted {
    /// Threads so far.
    pub(super) fn number(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }
}

impl Spawner for Counted {
    fn spawn(&self, name: String, body: Box<dyn FnOnce() + Send + 'static>) -> io::Result<JoinHandle<()>> {
        self.0.fetch_add(1, Ordering::Relaxed);
        SystemThreads.spawn(name, body)
    }
}

/// Times empty jobs under each of these strategies, given as in [`super::Settings::strategy`]: one calibration for each
/// number of `calibrations`.
pub fn calibrate(lab: &Lab, strategies: &[String], calibrations: Range<u32>) -> Result<Vec<CalibrationRow>> {
    let mut rows = Vec::new();
    for strategy in strategies {
        let (entry, _) = lab.strategy_named(strategy)?;
        let (threads, jobs) = match entry.workers {
            Workers::Caller => (vec![1], JOBS),
            Workers::PerJob => (vec![1], JOBS_WITH_THREADS),
            Workers::Threads => (thread_counts(available_threads()), JOBS),
        };
        for threads in threads {
            rows.extend(jobs.map(|jobs| CalibrationRow {
                strategy: strategy.clone(),
                threads,
                jobs,
                seconds: 0.0,
                cpu_s: None,
                started: 0,
                calibration: 0,
            }));
        }
    }
    let mut all = Vec::new();
    for calibration in calibrations {
        all.extend(calibrated(lab, &rows)?.into_iter().map(|row| CalibrationRow { calibration, ..row }));
    }
    Ok(all)
}

/// One calibration: these rows with their median times.
fn calibrated(lab: &Lab, rows: &[CalibrationRow]) -> Result<Vec<CalibrationRow>> {
    let mut rounds: Vec<Vec<CalibrationRow>> = vec![Vec::new(); rows.len()];
    let start = Instant::now();
    for round in 0..=ROUNDS {
        if round > 3 && start.elapsed() > BUDGET {
            break;
        }
        for (row, of_row) in rows.iter().zip(&mut rounds) {
            let timed = run_empty_jobs(lab, row)?;
            if round > 0 {
                of_row.push(timed);
            }
        }
    }
    Ok(rounds.iter().filter_map(|rounds| CalibrationRow::median(rounds)).collect())
}

impl CalibrationRow {
    /// The row with the median times of several rows of one schedule; `None` without rows.
    pub fn median<R: Borrow<Self>>(rows: &[R]) -> Option<Self> {
        let last = rows.last()?.borrow();
        let seconds: Vec<f64> = rows.iter().map(|row| row.borrow().seconds).collect();
        let cpu_s: Vec<f64> = rows.iter().filter_map(|row| row.borrow().cpu_s).collect();
        Some(Self { seconds: median(&seconds)?, cpu_s: median(&cpu_s), ..last.clone() })
    }
}

/// Writes calibrations of all strategies of the table to `calibration.csv`, beside the rows of a sweep, until there are
/// `wanted` of them. Calibrations that the file already has stay.
pub fn write_calibrations(lab: &Lab, path: &Path, wanted: u32) -> Result<()> {
    let mut rows = if path.is_file() { read_calibration(path)? } else { Vec::new() };
    let first = rows.iter().map(|row| row.calibration + 1).max().unwrap_or(0);
    if first >= wanted {
        return Ok(());
    }
    let strategies: Vec<String> = lab.strategies().iter().map(|entry| entry.name.to_string()).collect();
    rows.extend(calibrate(lab, &strategies, first..wanted)?);
    csv_file::write(path, rows)
}

/// Each calibration of a file is replayed, so a number above this is a damaged file.
const MOST: u32 = 1000;

pub fn read_calibration(path: &Path) -> Result<Vec<CalibrationRow>> {
    let rows: Vec<CalibrationRow> = csv_file::read(path)?;
    match rows.iter().position(|row| row.calibration >= MOST) {
        None => Ok(rows),
        Some(index) => {
            let error = InputError::new("calibration", rows[index].calibration.to_string(), "is too large");
            let allowed = error.allowed(format!("at most {}", MOST - 1));
            Err(allowed.in_file(path.display().to_string(), Some((index + 2, 1))).into())
        }
    }
}

/// The calibrations of several files, numbered one after the other.
pub fn joined_calibrations(files: Vec<Vec<CalibrationRow>>) -> Vec<CalibrationRow> {
    let mut joined: Vec<CalibrationRow> = Vec::new();
    for rows in files {
        let first = joined.iter().map(|row| row.calibration + 1).max().unwrap_or(0);
        joined.extend(rows.into_iter().map(|row| CalibrationRow { calibration: first + row.calibration, ..row }));
    }
    joined
}

/// 1, 2, 4 and so on below `most`, and `most`.
fn thread_counts(most: usize) -> Vec<usize> {
    let doubled = std::iter::successors(Some(1), |threads| Some(2 * threads)).take_while(|threads| *threads < most);
    doubled.chain([most]).collect()
}

fn run_empty_jobs(lab: &Lab, row: &CalibrationRow) -> Result<CalibrationRow> {
    let (entry, parameter) = lab.strategy_named(&row.strategy)?;
    let failed = |error| Error::system("calibrating strategy", entry.name, std::io::Error::other(error));
    let threads = NonZeroUsize::new(row.threads).unwrap_or(NonZeroUsize::MIN);
    let spawner = Arc::new(Counted::default());
    let config = Config { parameter, spawner: spawner.clone(), ..Config::new(threads) };
    let mut strategy = entry.build(config).map_err(failed)?;
    let before = spawner.number();
    let usage = Usage::now();
    let start = Instant::now();
    strategy.run(row.jobs, Arc::new(|index| _ = black_box(index))).map_err(failed)?;
    let seconds = start.elapsed().as_secs_f64();
    let used = usage.zip(Usage::now()).map(|(before, after)| after.since(&before));
    let started = spawner.number() - before;
    let cpu_s = used.map(|used| used.user_s + used.system_s);
    Ok(CalibrationRow { seconds, cpu_s, started, ..row.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strategy::STRATEGIES;

    #[test]
    fn thread_counts_double_and_end_with_all() {
        assert_eq!(thread_counts(1), [1]);
        assert_eq!(thread_counts(2), [1, 2]);
        assert_eq!(thread_counts(6), [1, 2, 4, 6]);
    }

    #[test]
    fn rows_survive_a_file() {
        let row = |cpu_s| CalibrationRow {
            strategy: "dynamic:4".to_owned(),
            threads: 2,
            jobs: 200,
            seconds: 0.1,
            cpu_s,
            started: 2,
            calibration: 3,
        };
        let rows = vec![row(None), row(Some(0.3))];
        let mut file = csv::Writer::from_writer(Vec::new());
        for row in &rows {
            file.serialize(row).unwrap();
        }
        let bytes = file.into_inner().unwrap();
        let read: std::result::Result<Vec<CalibrationRow>, _> =
            csv::Reader::from_reader(&*bytes).deserialize().collect();
        assert_eq!(read.unwrap(), rows);
    }

    /// A file of an earlier version has no column for the calibration.
    #[test]
    fn an_older_file_is_one_calibration() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("calibration.csv");
        std::fs::write(&path, "strategy,threads,jobs,seconds,cpu_s,started\nserial,1,200,0.5,,0\n").unwrap();
        assert_eq!(read_calibration(&path).unwrap()[0].calibration, 0);
    }

    #[test]
    fn a_damaged_number_is_refused_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("calibration.csv");
        let rows = "serial,1,200,0.5,,0,999\nserial,1,200,0.5,,0,4294967295\n";
        std::fs::write(&path, format!("strategy,threads,jobs,seconds,cpu_s,started,calibration\n{rows}")).unwrap();
        let error = read_calibration(&path).unwrap_err().to_string();
        assert!(error.contains("calibration.csv:3") && error.contains("at most 999"), "{error}");
    }

    #[test]
    fn joined_calibrations_stay_apart() {
        let row = |calibration: u32, seconds: f64| CalibrationRow {
            strategy: "serial".to_owned(),
            threads: 1,
            jobs: 200,
            seconds,
            cpu_s: None,
            started: 0,
            calibration,
        };
        let joined = joined_calibrations(vec![vec![row(0, 1.0), row(1, 2.0)], vec![], vec![row(0, 3.0), row(1, 4.0)]]);
        let told: Vec<(u32, f64)> = joined.iter().map(|row| (row.calibration, row.seconds)).collect();
        assert_eq!(told, [(0, 1.0), (1, 2.0), (2, 3.0), (3, 4.0)]);
    }

    /// A second call adds the missing calibrations, and a third one changes nothing.
    #[test]
    fn calibrations_are_added_to_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("calibration.csv");
        let lab = Lab::new();
        write_calibrations(&lab, &path, 1).unwrap();
        let before = read_calibration(&path).unwrap();
        write_calibrations(&lab, &path, 2).unwrap();
        let after = read_calibration(&path).unwrap();
        assert_eq!(after[..before.len()], before[..]);
        assert_eq!(after.len(), 2 * before.len());
        assert!(after[before.len()..].iter().all(|row| row.calibration == 1));
        write_calibrations(&lab, &path, 2).unwrap();
        assert_eq!(read_calibration(&path).unwrap(), after);
    }

    /// Each strategy gets a positive time for two numbers of jobs, and an unknown strategy is refused.
    #[test]
    fn every_strategy_is_timed() {
        let names: Vec<String> = STRATEGIES.iter().map(|entry| entry.name.to_owned()).collect();
        let rows = calibrate(&Lab::new(), &names, 0..1).unwrap();
        for name in &names {
            let of: Vec<_> = rows.iter().filter(|row| &row.strategy == name).collect();
            assert!(of.len() >= 2 && of.iter().all(|row| row.seconds > 0.0), "{of:?}");
        }
        assert!(calibrate(&Lab::new(), &["no-such-strategy".to_owned()], 0..1).is_err());
    }
}
