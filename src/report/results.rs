//! What an experiment left in its folder, and the groupings that figures need.

use crate::analysis::bootstrap::paired_ratio;
use crate::analysis::quantile::{median, median_interval};
use crate::analysis::{Estimate, Interval};
use crate::error::Result;
use crate::experiment::{Definition, Profile, RunFile, read_records, read_run_file};
use crate::input::read_text;
use crate::measure::{Record, schedule_name};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Confidence of every interval in the report.
pub(super) const LEVEL: f64 = 0.95;

/// An experiment's definition, machine and rows.
pub struct Results {
    /// The definition as it was run.
    pub definition: Definition,
    /// Command and machine.
    pub run: RunFile,
    /// Rows that did not fail.
    pub records: Vec<Record>,
    /// Rows that failed.
    pub failed: Vec<Record>,
    /// The experiment's folder.
    pub folder: PathBuf,
    /// The folder that holds all experiments and the references.
    pub out: PathBuf,
}

/// A schedule: strategy, decomposition, threads. `thread-per-row` is named as report A names it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Schedule {
    pub(super) strategy: String,
    pub(super) decomposition: String,
    pub(super) threads: usize,
}

impl Schedule {
    pub(super) fn of(record: &Record) -> Self {
        Self {
            strategy: schedule_name(&record.strategy, &record.decomposition).to_string(),
            decomposition: record.decomposition.clone(),
            threads: record.threads,
        }
    }
}

/// The median of some times with its distribution-free interval.
pub(super) fn median_with_interval(values: &[f64]) -> Option<(f64, Option<Interval>)> {
    Some((median(values)?, median_interval(values, LEVEL)))
}

impl Results {
    /// Reads a folder that a sweep wrote.
    pub fn read(out: &Path, folder: &Path) -> Result<Self> {
        let path = folder.join("experiment.toml");
        let name = folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let definition = Definition::from_text(&name, &path.display().to_string(), &read_text(&path)?)?;
        let run = read_run_file(&folder.join("machine.toml"))?;
        let rows = read_records(&folder.join("records.csv"))?;
        let (records, failed) = rows.into_iter().partition(|record: &Record| record.error.is_empty());
        Ok(Self { definition, run, records, failed, folder: folder.to_path_buf(), out: out.to_path_buf() })
    }

    /// Quick or full.
    pub fn profile(&self) -> Profile {
        Profile::from_name(&self.run.profile).unwrap_or(Profile::Quick)
    }

    /// Size and machine in a line, for below a figure's title.
    pub(super) fn workload(&self) -> String {
        let size = self
            .records
            .first()
            .map_or_else(String::new, |record| format!("{}, {}x{}, ", record.scene, record.width, record.height));
        let machine = &self.run.machine;
        format!("{size}{} processors, {}", machine.processors, machine.cpu)
    }

    /// Rows by a key, in the order of the key.
    pub(super) fn by<K: Ord>(&self, key: impl Fn(&Record) -> K) -> BTreeMap<K, Vec<&Record>> {
        let mut groups: BTreeMap<K, Vec<&Record>> = BTreeMap::new();
        for record in &self.records {
            groups.entry(key(record)).or_default().push(record);
        }
        groups
    }

    /// How much faster each schedule is than `serial`: the median of the ratios of runs of the same image in the same repetition.
    pub(super) fn speedups(&self) -> Vec<(Schedule, Estimate)> {
        let same_run = |record: &Record| (record.spp, record.seed, record.estimator.clone(), record.repetition);
        let serial: BTreeMap<_, f64> = self
            .records
            .iter()
            .filter(|record| record.strategy == "serial")
            .filter_map(|record| Some((same_run(record), record.makespan_s?)))
            .collect();
        let mut speedups = Vec::new();
        for (schedule, records) in self.by(Schedule::of) {
            let pairs = records.iter().filter_map(|record| Some((*serial.get(&same_run(record))?, record.makespan_s?)));
            let (baseline, times): (Vec<f64>, Vec<f64>) = pairs.unzip();
            if schedule.strategy != "serial"
                && let Some(estimate) = paired_ratio(&baseline, &times, LEVEL)
            {
                speedups.push((schedule, estimate));
            }
        }
        speedups
    }
}
