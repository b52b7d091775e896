//! The file of a trace: a line of JSON behind a `#` that describes the run, then a row of CSV for each job.
//!
//! ```text
//! # {"settings":{"scene":"cornell","spp":16,...},"makespan_s":0.18,"workers":2}
//! job,worker,start_s,stop_s,paths,rays,x0,y0,x1,y1,first_sample,samples
//! 0,1,0.000041,0.00193,4096,30211,0,0,16,16,0,16
//! ```

use super::{JobSpan, Outcome, Settings, Setup, TimingConcerns, Trace};
use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::film::{Bounds, Piece};
use crate::input::{Limits, open_text, unreadable};
use serde::{Deserialize, Serialize};
use std::io::ErrorKind::OutOfMemory;
use std::io::{self, BufRead};
use std::path::Path;

/// Limits with room for more jobs than a film can have pixels, at some 60 bytes a row. The header has some 700 bytes
/// and the longest path of a scene.
const LIMITS: Limits = Limits { bytes: 1 << 33, line: 1 << 14 };

/// The run and its duration.
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

/// One job.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TraceRow {
    /// Index of the job.
    pub job: usize,
    /// The worker, numbered in the order in which workers ran their first jobs.
    pub worker: u32,
    /// Start, in seconds since the run's start.
    pub start_s: f64,
    /// End, in seconds since the run's start.
    pub stop_s: f64,
    /// Number of samples.
    pub paths: u64,
    pub rays: u64,
    /// First column of its piece.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
    /// First sample of each pixel.
    pub first_sample: u32,
    /// Samples of each pixel.
    pub samples: u32,
}

/// A run, job by job.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceFile {
    /// The run and its duration.
    pub header: TraceHeader,
    /// The jobs in index order.
    pub rows: Vec<TraceRow>,
}

impl TraceFile {
    /// Returns the file of a run.
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

    /// Seconds of each job, in index order.
    pub fn costs_s(&self) -> Vec<f64> {
        self.trace().durations_s()
    }

    /// Which worker ran which job when.
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

    /// Reads a file that [`TraceFile::write`] wrote.
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
