//! One repetition of one cell, in a process of its own: memory, caches, CPU time and thread counts of one run are not those of another,
//! and a crash is a row instead of the end of the sweep.
//!
//! The parent writes a [`CellJob`] as a line of JSON to the child's standard input and keeps that open; the child answers with a record as
//! JSON on its standard output. A child whose input ends has lost its parent and stops, so that no orphan disturbs the sweep that goes on
//! in its place.

use crate::error::{Error, InputError, Result};
use crate::film::{Film, read_film};
use crate::image_io;
use crate::measure::{Measured, Record, Settings, Setup, TraceFile, failure};
use crate::metric;
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// What a child is asked to do.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CellJob {
    /// The experiment's name.
    pub experiment: String,
    /// The cell's word.
    pub cell: String,
    /// Which repetition.
    pub repetition: u32,
    /// Position in the sweep.
    pub order: u64,
    /// What to run.
    pub settings: Settings,
    /// The two half-references, if errors are to be measured.
    pub references: Option<[PathBuf; 2]>,
    /// Where to keep the image.
    pub image: Option<PathBuf>,
    /// Where to keep the trace.
    pub trace: Option<PathBuf>,
}

impl CellJob {
    fn label(&self, record: Record) -> Record {
        Record {
            experiment: self.experiment.clone(),
            cell: self.cell.clone(),
            repetition: self.repetition,
            order: self.order,
            ..record
        }
    }

    /// Runs the cell in a child; whatever goes wrong there becomes a failed row.
    pub(super) fn run_in_child(&self) -> Record {
        self.label(self.child().unwrap_or_else(|error| failure(&self.settings, &error)))
    }

    fn child(&self) -> std::result::Result<Record, String> {
        let program = std::env::current_exe().map_err(|e| format!("finding this program: {e}"))?;
        let mut child = Command::new(program)
            .arg("cell")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|e| format!("starting a process for the cell: {e}"))?;
        let text = serde_json::to_string(self).map_err(|e| format!("describing the cell: {e}"))?;
        let mut input = child.stdin.take();
        // A child that dies early closes its end; its exit status tells more than this write.
        let written = input.as_mut().map_or(Ok(()), |stdin| writeln!(stdin, "{text}"));
        let output = child.wait_with_output().map_err(|e| format!("waiting for the cell's process: {e}"))?;
        drop(input);
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr);
            return Err(format!("the cell's process ended with {}: {}", output.status, said.trim()));
        }
        written.map_err(|e| format!("telling the cell's process what to do: {e}"))?;
        serde_json::from_slice(&output.stdout).map_err(|e| format!("reading what the cell's process said: {e}"))
    }

    fn run(&self) -> Result<Record> {
        let setup = Setup::prepare(self.settings.clone())?;
        let outcome = setup.run(None)?;
        let errors = match &self.references {
            Some(references) => self.errors(&outcome.film, references)?,
            None => Measured::default(),
        };
        if let Some(path) = &self.image {
            image_io::write(path, &outcome.film.image())?;
        }
        if let Some(path) = &self.trace {
            TraceFile::new(&setup, &outcome).write(path)?;
        }
        Ok(self.label(Record::new(&setup, &outcome, errors)))
    }

    fn errors(&self, film: &Film, references: &[PathBuf; 2]) -> Result<Measured> {
        let [(first_key, first), (second_key, second)] = [read_film(&references[0])?, read_film(&references[1])?];
        let seed = self.settings.spec.seed;
        if first_key.seed == second_key.seed || [first_key.seed, second_key.seed].contains(&seed) {
            let problem = "the image and its two half-references must have three different seeds";
            return Err(InputError::new("seed", seed.to_string(), problem).into());
        }
        let (image, first, second) = (film.image(), first.image(), second.image());
        let mse = metric::cross_mse(&image, &first, &second)?;
        let mse_display = metric::cross_mse_display(&image, &first, &second)?;
        Ok(Measured { mse: Some(mse), mse_display: Some(mse_display) })
    }
}

/// The child's side: reads a job, answers with a record.
pub fn child_main() -> Result<()> {
    let mut text = String::new();
    std::io::stdin().read_line(&mut text).map_err(|e| Error::system("reading", "standard input", e))?;
    let job: CellJob = serde_json::from_str(&text)
        .map_err(|e| InputError::new("standard input", "", format!("is no description of a cell: {e}")))?;
    std::thread::spawn(|| {
        // Nothing more is ever sent: this returns when the parent is gone.
        let _ = std::io::copy(&mut std::io::stdin(), &mut std::io::sink());
        std::process::exit(3);
    });
    let record = job.run()?;
    let answer = serde_json::to_string(&record).map_err(|e| Error::system("writing", "standard output", e.into()))?;
    writeln!(std::io::stdout(), "{answer}").map_err(|e| Error::system("writing", "standard output", e))
}
