//! Traces of runs: which worker ran which job when. The file of a trace is a line of JSON behind a `#` that describes the
//! run, then a row of CSV for each job.
//!
//! ```text
//! # {"settings":{"scene":"cornell","spp":16,...},"makespan_s":0.18,"workers":2}
//! job,worker,start_s,stop_s,paths,rays,x0,y0,x1,y1,first_sample,samples
//! 0,1,0.000041,0.00193,4096,30211,0,0,16,16,0,16
//! ```

use super::{Outcome, Settings, Setup, TimingConcerns};
use crate::analysis::balance::{Balance, of_spans};
use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::film::{Bounds, Piece};
use crate::input::{Limits, open_text, unreadable};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::ErrorKind::OutOfMemory;
use std::io::{self, BufRead};
use std::path::Path;

/// The time of one job, in seconds since the run's start.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JobSpan {
    /// The worker, numbered in the order in which workers ran their first jobs.
    pub worker: u32,
    pub start_s: f64,
    pub stop_s: f64,
}

impl JobSpan {
    pub fn duration_s(&self) -> f64 {
        self.stop_s - self.start_s
    }

    /// The same job in a run that started `offset_s` seconds earlier.
    #[must_use]
    pub(super) fn later_by(&self, offset_s: f64) -> Self {
        Self { start_s: self.start_s + offset_s, stop_s: self.stop_s + offset_s, ..*self }
    }
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trace {
    pub jobs: Vec<JobSpan>,
}

impl Trace {
    /// How `workers` workers spent their time in a run of that makespan; `None` for impossible spans.
    pub fn balance(&self, makespan_s: f64, workers: usize) -> Option<Balance> {
        of_spans(self.jobs.iter().map(|job| (job.worker as usize, job.start_s, job.stop_s)), makespan_s, workers)
    }

    /// Seconds from the run's start to each worker's first job, over all workers that had one.
    pub fn starting_s(&self) -> f64 {
        let mut first: BTreeMap<u32, f64> = BTreeMap::new();
        for JobSpan { worker, start_s, .. } in &self.jobs {
            first.entry(*worker).and_modify(|first| *first = first.min(*start_s)).or_insert(*start_s);
        }
        first.into_values().sum()
    }

    pub fn durations_s(&self) -> Vec<f64> {
        self.jobs.iter().map(JobSpan::duration_s).collect()
    }
}

/// Limits with room for more jobs than a film can have pixels, at some 60 bytes a row. The header has some 700 bytes
/// and the longest path of a scene.
const LIMITS: Limits = Limits { bytes: 1 << 33, line: 1 << 14 };

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TraceHeader {
    pub settings: Settings,
    /// Seconds from handing over the jobs until all were done.
    pub makespan_s: f64,
    /// Threads that ran at least one job.
    pub workers: u32,
    /// Doubts about the run, as a row has them.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub warnings: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TraceRow {
    pub job: usize,
    /// The worker, numbered in the order in which workers ran their first jobs.
    pub worker: u32,
    /// Start, in seconds since the run's start.
    pub start_s: f64,
    pub stop_s: f64,
    pub paths: u64,
    pub rays: u64,
    /// First column of its piece.
    pub x0: u32,
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    pub y1: u32,
    /// First sample of each pixel.
    pub first_sample: u32,
    pub samples: u32,
}

#[derive(Debug, Clone, PartialEq)]
pub struct TraceFile {
    pub header: TraceHeader,
    pub rows: Vec<TraceRow>,
}

impl TraceFile {
    pub fn new(setup: &Setup, outcome: &Outcome) -> Self {
        let jobs = outcome.trace.jobs.iter().zip(&outcome.job_counts).zip(outcome.plan.pieces()).enumerate();
        let rows = jobs.map(|(job, ((span, counts), piece))| {
            let Piece { bounds: Bounds { x0, y0, x1, y1 }, samples } = piece.clone();
            let JobSpan { worker, start_s, stop_s } = *span;
            let (paths, rays, first_sample) = (counts.paths, counts.rays, samples.start);
            let samples = samples.end - samples.start;
            TraceRow { job, worker, start_s, stop_s, paths, rays, x0, y0, x1, y1, first_sample, samples }
        });
        let settings = Settings { spp: outcome.spp, ..setup.settings().clone() };
        let (makespan_s, workers, warnings) = (outcome.makespan_s, outcome.workers_used, outcome.warned());
        let header = TraceHeader { settings, makespan_s, workers, warnings };
        Self { header, rows: rows.collect() }
    }

    /// A warning with the doubts about the times when they were measured; `None` if there were none.
    pub fn doubt(&self) -> Option<String> {
        let warnings = &self.header.warnings;
        TimingConcerns::concern(warnings).then(|| format!("warning: the times of this trace are in doubt: {warnings}"))
    }

    pub fn costs_s(&self) -> Vec<f64> {
        self.trace().durations_s()
    }

    pub fn trace(&self) -> Trace {
        let span = |row: &TraceRow| JobSpan { worker: row.worker, start_s: row.start_s, stop_s: row.stop_s };
        Trace { jobs: self.rows.iter().map(span).collect() }
    }

    /// Writes the file, whole or not at all.
    pub fn write(&self, path: &Path) -> Result<()> {
        let system = |e: std::io::Error| Error::system("writing", path, e);
        let header = serde_json::to_string(&self.header).map_err(|e| system(e.into()))?;
        let mut writer = csv::Writer::from_writer(format!("# {header}\n").into_bytes());
        for row in &self.rows {
            writer.serialize(row).map_err(|e| system(e.into()))?;
        }
        let bytes = writer.into_inner().map_err(|e| system(e.into_error()))?;
        atomic_file::write(path, |file| file.write_all(&bytes))
    }

    pub fn read(path: &Path) -> Result<Self> {
        let mut table = open_text(path, LIMITS)?;
        let mut first = Vec::new();
        table.read_until(b'\n', &mut first).map_err(|e| unreadable(path, e))?;
        let first = String::from_utf8_lossy(&first);
        let wrong = |line: usize, field: &str, value: &str, problem: String| -> Error {
            InputError::new(field, value, problem).in_file(path.display().to_string(), Some((line, 1))).into()
        };
        let Some(json) = first.strip_prefix("# ") else {
            let problem = "is not the first line of a trace, which begins with `# {`".to_string();
            return Err(wrong(1, "header", &first.trim_end().chars().take(40).collect::<String>(), problem));
        };
        let header: TraceHeader =
            serde_json::from_str(json).map_err(|e| wrong(1, "header", "", format!("cannot be read: {e}")))?;
        if !(header.makespan_s > 0.0 && header.makespan_s.is_finite()) {
            return Err(wrong(1, "makespan_s", &header.makespan_s.to_string(), "must be positive".to_string()));
        }
        let mut rows = Vec::new();
        for (index, row) in csv::Reader::from_reader(table).deserialize::<TraceRow>().enumerate() {
            let line = index + 3;
            let row = row.map_err(|e| wrong(line, "row", "", format!("cannot be read: {e}")))?;
            let ordered = row.start_s >= 0.0 && row.stop_s >= row.start_s && row.stop_s.is_finite();
            if row.job != index {
                return Err(wrong(line, "job", &row.job.to_string(), format!("expected {index}")));
            }
            if !ordered || row.x1 <= row.x0 || row.y1 <= row.y0 {
                return Err(wrong(line, "row", "", "contains invalid times or no pixels".to_string()));
            }
            if row.worker >= header.workers {
                let problem = format!("is not a worker of this run, which had {}", header.workers);
                return Err(wrong(line, "worker", &row.worker.to_string(), problem));
            }
            rows.try_reserve(1).map_err(|e| Error::system("reading", path, io::Error::new(OutOfMemory, e)))?;
            rows.push(row);
        }
        if rows.is_empty() {
            return Err(wrong(2, "rows", "", "there are none".to_string()));
        }
        if header.workers as usize > rows.len() {
            let problem = format!("is more than the {} jobs of the trace", rows.len());
            return Err(wrong(1, "workers", &header.workers.to_string(), problem));
        }
        Ok(Self { header, rows })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worker 1 begins half a second late, and worker 0 has a second job, in any order of the jobs.
    #[test]
    fn each_worker_starts_with_its_first_job() {
        let span = |(worker, start_s): (u32, f64)| JobSpan { worker, start_s, stop_s: start_s + 0.25 };
        let trace = Trace { jobs: [(0, 1.0), (1, 0.5), (0, 0.125), (1, 0.75)].map(span).to_vec() };
        assert_eq!((trace.starting_s(), Trace::default().starting_s()), (0.625, 0.0));
    }
}
