//! What an experiment left in its folder, and the groupings that figures need.

use crate::analysis::quantile::{median, median_interval};
use crate::analysis::{Estimate, Interval};
use crate::error::Result;
use crate::experiment::{Definition, Profile, RunFile, read_records, read_run_file, trace_file};
use crate::image_io::{self, Image};
use crate::input::read_text;
use crate::lab::Lab;
use crate::measure::{Record, TraceFile, schedule_name};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

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
    /// Strategy and threads, in words.
    pub(super) fn label(&self) -> String {
        match self.threads {
            1 => format!("{}, 1 thread", self.strategy),
            threads => format!("{}, {threads} threads", self.strategy),
        }
    }

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
    pub fn read(lab: &Arc<Lab>, out: &Path, folder: &Path) -> Result<Self> {
        let path = folder.join("experiment.toml");
        let name = folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let definition = Definition::from_text(lab, &name, &path.display().to_string(), &read_text(&path)?)?;
        let run = read_run_file(&folder.join("machine.toml"))?;
        let rows = read_records(&folder.join("records.csv"))?;
        let (records, failed) = rows.into_iter().partition(|record: &Record| record.error.is_empty());
        Ok(Self { definition, run, records, failed, folder: folder.to_path_buf(), out: out.to_path_buf() })
    }

    /// Reads an experiment's folder by itself.
    pub fn open(lab: &Arc<Lab>, folder: &Path) -> Result<Self> {
        let out = folder.parent().unwrap_or(Path::new(""));
        Self::read(lab, out, folder)
    }

    /// Of the serial runs whose trace was kept, the one of the most jobs, and of its repetitions the one with the median time.
    pub fn largest_serial_trace(&self) -> Result<Option<TraceFile>> {
        let serial = || self.records.iter().filter(|record| record.strategy == "serial");
        let most = serial().map(|record| record.jobs).max();
        let records: Vec<&Record> = serial().filter(|record| Some(record.jobs) == most).collect();
        Self::typical(&records).map_or(Ok(None), |record| self.trace(record))
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
        format!("{size}{}", self.machine_line())
    }

    /// The machine alone, where the figure's rows differ in scene or size.
    pub(super) fn machine_line(&self) -> String {
        self.run.machine.line()
    }

    /// What is rendered, apart from samples and seed, where the experiment compares several; empty where there is only one.
    pub(super) fn series_name(&self, record: &Record) -> String {
        let parts: [fn(&Record) -> &str; 4] = [|r| &r.scene, |r| &r.estimator, |r| &r.sampler, |r| &r.output];
        let differs = |part: &fn(&Record) -> &str| self.records.iter().any(|other| part(other) != part(record));
        parts.iter().filter(|part| differs(part)).map(|part| part(record)).collect::<Vec<_>>().join(", ")
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
        let serial = self.times(|schedule| schedule.strategy == "serial");
        let schedules = self.by(Schedule::of).into_keys().filter(|schedule| schedule.strategy != "serial");
        schedules
            .filter_map(|schedule| {
                // On its own pieces where serial ran on them: other pieces change the caches, if nothing else.
                let on_same_pieces =
                    self.times(|s| s.strategy == "serial" && s.decomposition == schedule.decomposition);
                let baseline = if on_same_pieces.is_empty() { &serial } else { &on_same_pieces };
                let ratio = ratio(baseline, &self.times(|s| *s == schedule))?;
                Some((schedule, ratio))
            })
            .collect()
    }

    /// How many times as long `other` takes as `schedule`, by runs of the same image in the same repetition.
    pub(super) fn time_ratio(&self, other: &Schedule, schedule: &Schedule) -> Option<Estimate> {
        ratio(&self.times(|s| s == other), &self.times(|s| s == schedule))
    }

    /// The speedups of a schedule against `serial` on the same pieces, one for each image and repetition that both have.
    pub(super) fn paired_speedups(&self, schedule: &Schedule) -> Vec<f64> {
        let serial = self.times(|s| s.strategy == "serial" && s.decomposition == schedule.decomposition);
        ratios(&serial, &self.times(|s| s == schedule))
    }

    /// CPU time of a schedule over that of `serial` on the same pieces, in the same repetition: what the same work costs more when several
    /// processors do it, and what the schedule itself costs. The median of the ratios.
    pub(super) fn work_inflation(&self, schedule: &Schedule) -> Option<f64> {
        let serial =
            self.values(Record::cpu_s, |s| s.strategy == "serial" && s.decomposition == schedule.decomposition);
        median(&ratios(&self.values(Record::cpu_s, |s| s == schedule), &serial))
    }

    /// How many times as long rows of one kind take as rows of another, paired by image but for the sampler, and by repetition.
    pub(super) fn kind_ratio(
        &self,
        other: impl Fn(&Record) -> bool,
        kind: impl Fn(&Record) -> bool,
    ) -> Option<Estimate> {
        let times = |is_wanted: &dyn Fn(&Record) -> bool| {
            let wanted = self.records.iter().filter(|record| is_wanted(record));
            let key =
                |record: &Record| (format!("{} {} {}", record.scene_hash, record.spp, record.seed), record.repetition);
            wanted.filter_map(|record| Some((key(record), record.makespan_s?))).collect()
        };
        ratio(&times(&other), &times(&kind))
    }

    /// The trace of a row, if it was kept.
    pub(super) fn trace(&self, record: &Record) -> Result<Option<TraceFile>> {
        let path = self.folder.join("traces").join(trace_file(&record.cell, record.repetition));
        if path.is_file() { TraceFile::read(&path).map(Some) } else { Ok(None) }
    }

    /// The images that were kept of the rows that are wanted, in the order of the rows.
    pub(super) fn kept_images(&self, is_wanted: impl Fn(&Record) -> bool) -> Result<Vec<(&Record, Image)>> {
        let cells = self.definition.cells(self.profile())?;
        let mut images = Vec::new();
        for record in self.records.iter().filter(|record| record.repetition == 0 && is_wanted(record)) {
            let point = cells.iter().flat_map(|cell| &cell.points).find(|point| point.id == record.cell);
            let path = point.map(|point| self.folder.join("images").join(point.image_file()));
            if let Some(path) = path.filter(|path| path.is_file()) {
                images.push((record, image_io::read(&path)?));
            }
        }
        Ok(images)
    }

    /// The row with the median time, the lower one of two.
    pub(super) fn typical<'a>(records: &[&'a Record]) -> Option<&'a Record> {
        let mut timed: Vec<&Record> = records.iter().copied().filter(|record| record.makespan_s.is_some()).collect();
        timed.sort_by(|a, b| a.makespan_s.unwrap_or(0.0).total_cmp(&b.makespan_s.unwrap_or(0.0)));
        timed.get(timed.len().checked_sub(1)? / 2).copied()
    }

    /// The makespans of the schedules that are wanted, by image and repetition.
    fn times(&self, is_wanted: impl Fn(&Schedule) -> bool) -> BTreeMap<(String, u32), f64> {
        self.values(|record| record.makespan_s, is_wanted)
    }

    /// A value of the rows of the schedules that are wanted, by image and repetition.
    fn values(
        &self,
        value: fn(&Record) -> Option<f64>,
        is_wanted: impl Fn(&Schedule) -> bool,
    ) -> BTreeMap<(String, u32), f64> {
        let wanted = self.records.iter().filter(|record| is_wanted(&Schedule::of(record)));
        wanted.filter_map(|record| Some(((image(record), record.repetition), value(record)?))).collect()
    }
}

/// What tells images apart.
pub(super) fn image(record: &Record) -> String {
    let what = format!("{} {} {}", record.scene_hash, record.estimator, record.sampler);
    format!("{what} {}x{} {} {}", record.width, record.height, record.spp, record.seed)
}

fn ratios(numerator: &BTreeMap<(String, u32), f64>, denominator: &BTreeMap<(String, u32), f64>) -> Vec<f64> {
    denominator.iter().filter_map(|(key, below)| Some(numerator.get(key)? / below)).collect()
}

/// The median of the ratios of values with the same key, with its distribution-free interval.
fn ratio(numerator: &BTreeMap<(String, u32), f64>, denominator: &BTreeMap<(String, u32), f64>) -> Option<Estimate> {
    let (value, interval) = median_with_interval(&ratios(numerator, denominator))?;
    Some(Estimate { value, interval: interval? })
}

/// An interval with the confidence that it really has: few values cannot reach 95 %.
pub(super) fn with_level(interval: &Interval, digits: usize) -> String {
    format!("{:.digits$} to {:.digits$} ({:.1} %)", interval.low, interval.high, interval.level * 100.0)
}

/// The confidence of some intervals of medians, in words for a caption.
pub(super) fn confidence(intervals: &[Interval]) -> String {
    let least = intervals.iter().map(|interval| interval.level).reduce(f64::min);
    least.map_or_else(
        || "no interval, for want of repetitions".to_string(),
        |least| {
            format!("distribution-free interval of the median, {:.1} % confidence", (least * 1000.0).floor() / 10.0)
        },
    )
}
