//! Cell processes: each repetition of a cell runs in its own process. Memory, caches, CPU time and thread counts of two
//! runs are therefore separate, and a crash gives a failed row instead of ending the sweep.
//!
//! The parent writes a [`CellJob`] as a line of JSON to the child's standard input and keeps that open; the child
//! answers with its rows as JSON on its standard output. A child whose input ends has lost its parent. It stops,
//! together with all processes it started, so that no orphan disturbs a resumed sweep.
//!
//! A child whose job says so stays, and runs its cell again for each further line: runs that are compared in pairs follow
//! each other at once ([`super::pairs`]).

use super::external::filled;
use super::object_pixels::{object_pixels, only};
use super::pairs::LONG_S;
use super::process_group;
use super::processes::run_processes;
use super::time_limit::timed_out;
use super::{External, HalfFile, SceneVersion};
use crate::cluster::Cluster;
use crate::error::{Error, InputError, Result};
use crate::film::SAMPLE_BLOCK;
use crate::film_file::read_film;
use crate::image_io::{self, Image};
use crate::input::read_text;
use crate::kernel::DEVICE_NAME;
use crate::lab::Lab;
use crate::measure::{
    Outcome, Record, Rounds, Settings, Setup, TraceFile, Warning, batch_runs, failure, missing_external, run_external,
};
use crate::metric::cross_mse;
use serde::{Deserialize, Serialize};
use std::env;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

/// The beginning of the help of the verb `cell`. A program whose help contains it can run cells, so later builds must
/// keep these words.
pub const CELL_ABOUT: &str = "One cell of a sweep, read from standard input";

#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct CellJob {
    pub experiment: String,
    /// Its rows, in the order of samples per pixel: one, or the points of a curve.
    pub points: Vec<PointJob>,
    pub repetition: u32,
    pub order: u64,
    pub settings: Settings,
    pub scene: SceneVersion,
    /// The two half-references, if errors are to be measured.
    pub references: Option<[HalfFile; 2]>,
    /// The object on whose pixels errors are measured, too.
    #[serde(default)]
    pub object: Option<String>,
    /// The other program that renders it, and the folder in which that was built.
    pub external: Option<(External, PathBuf)>,
    /// The path for the trace; a curve has none.
    pub trace: Option<PathBuf>,
    /// Whether the process stays and runs the cell again for each further line of its input.
    #[serde(default)]
    pub stays: bool,
}

/// The first row of a process that stays.
struct Kept {
    setup: Setup,
    /// The runs of each row.
    runs: u32,
    first: Record,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointJob {
    pub cell: String,
    pub spp: u32,
    /// The path for the image, if it is kept.
    pub image: Option<PathBuf>,
}

/// The row of a batch of runs, the first of which gave this row.
fn batch(setup: &Setup, runs: u32, first: Record) -> Result<Record> {
    let mut rows = vec![first];
    for _ in 1..runs {
        rows.push(Record::new(setup, &setup.run(None)?));
    }
    Record::of_batch(&rows).ok_or_else(|| Error::Check("two runs of one setup gave different images".to_string()))
}

fn without_image(point: &PointJob) -> PointJob {
    PointJob { image: None, ..point.clone() }
}

impl CellJob {
    fn label(&self, point: &PointJob, record: Record) -> Record {
        Record {
            experiment: self.experiment.clone(),
            cell: point.cell.clone(),
            repetition: self.repetition,
            run_order: self.order,
            ..record
        }
    }

    /// The same cell without what a sweep keeps of it.
    pub(super) fn alone(&self) -> Self {
        let points = self.points.iter().map(without_image).collect();
        Self { points, references: None, object: None, trace: None, ..self.clone() }
    }

    /// Runs the cell in a child process, of another build if one is given, and returns a row for each point. An error
    /// there, and the end of the time limit, become failed rows.
    pub(super) fn run_in_child(&self, other: Option<&Path>, limit: Option<Duration>) -> Vec<Record> {
        let own = || env::current_exe().map_err(|e| format!("finding this program: {e}"));
        let program = other.map_or_else(own, |other| Ok(other.to_path_buf()));
        let rows = program.and_then(|program| self.child(&program, limit));
        rows.and_then(|answer| self.rows(&answer)).unwrap_or_else(|error| self.failed(&error))
    }

    /// The rows of an answer, one for each point.
    pub(super) fn rows(&self, answer: &[u8]) -> std::result::Result<Vec<Record>, String> {
        let rows: Vec<Record> =
            serde_json::from_slice(answer).map_err(|e| format!("reading the answer of the cell's process: {e}"))?;
        let wrong = || format!("the cell's process gave {} rows instead of {}", rows.len(), self.points.len());
        if rows.len() == self.points.len() { Ok(rows) } else { Err(wrong()) }
    }

    pub(super) fn failed(&self, error: &str) -> Vec<Record> {
        let failed = |point: &PointJob| {
            let settings = Settings { spp: point.spp, ..self.settings.clone() };
            self.label(point, failure(&settings, error))
        };
        self.points.iter().map(failed).collect()
    }

    fn child(&self, program: &Path, limit: Option<Duration>) -> std::result::Result<Vec<u8>, String> {
        let mut command = Command::new(program);
        command.arg("cell");
        let text = serde_json::to_string(self).map_err(|e| format!("describing the cell: {e}"))?;
        let output = process_group::answer(command, &text, limit)
            .map_err(|e| format!("running the cell's process: {e}"))?
            .ok_or_else(|| timed_out(limit))?;
        if !output.status.success() {
            return Err(ended(output.status, String::from_utf8_lossy(&output.stderr).trim()));
        }
        Ok(output.stdout)
    }

    fn run(&self, lab: &Lab, kept: &mut Option<Kept>) -> Result<Vec<Record>> {
        if let Some(ranks) = self.settings.ranks {
            return self.by_processes(lab, ranks);
        }
        let references = self.references.as_ref().map(|halves| self.read_references(halves)).transpose()?;
        if let Some((external, folder)) = &self.external {
            // This process did its part, so the row's error is the program's alone.
            let rows = self.other_program(lab, external, folder, references.as_ref());
            return Ok(rows.unwrap_or_else(|error| self.failed(&error.to_string())));
        }
        if self.settings.spec.kernel == DEVICE_NAME
            && let Some(rows) = self.without_device(lab)?
        {
            return Ok(rows);
        }
        if let [point] = self.points.as_slice() {
            let setup = self.setup(lab, point.spp)?;
            let mut outcome = setup.run(None)?;
            if self.stays && outcome.makespan_s < LONG_S {
                // The first run of a process is slower than the rest.
                outcome = setup.run(None)?;
            }
            if let Some(path) = &self.trace {
                TraceFile::new(&setup, &outcome).write(path)?;
            }
            let row = self.row(point, &setup, &outcome, references.as_ref())?;
            // With a time limit each run has an image of its own, which must be compared anew.
            if !self.stays || self.settings.time_limit_s.is_some() {
                return Ok(vec![row]);
            }
            let runs = batch_runs(outcome.makespan_s, self.settings.is_serial());
            let row = batch(&setup, runs, row)?;
            *kept = Some(Kept { setup, runs, first: row.clone() });
            return Ok(vec![row]);
        }
        self.curve(lab, references.as_ref())
    }

    /// Runs the cell again: with the setup of the first run, if that kept one. The image is the same, so it is neither
    /// written nor compared again.
    fn run_again(&self, lab: &Lab, kept: &mut Option<Kept>) -> Result<Vec<Record>> {
        let ([point], Some(Kept { setup, runs, first })) = (self.points.as_slice(), &kept) else {
            return self.run(lab, kept);
        };
        let row = self.row(&without_image(point), setup, &setup.run(None)?, None)?;
        Ok(vec![batch(setup, *runs, row)?.with_errors_of(first)])
    }

    /// The setup with `spp` samples per pixel; refuses a scene that has changed since the experiment began.
    fn setup(&self, lab: &Lab, spp: u32) -> Result<Setup> {
        let setup = lab.prepare(Settings { spp, ..self.settings.clone() })?;
        self.scene.check(&setup.hash())?;
        Ok(setup)
    }

    /// The rows of a cell for a GPU on a machine without one: they have not failed, but have no measurements. `None`
    /// with a GPU.
    fn without_device(&self, lab: &Lab) -> Result<Option<Vec<Record>>> {
        let setup = self.setup(lab, self.settings.spp)?;
        let is_without = setup.scene().is_some_and(|(_, choice)| choice.plan.lacks_device());
        let row = |point: &PointJob| self.left_out(point, &setup, &Warning::NoDevice);
        Ok(is_without.then(|| self.points.iter().map(row).collect()))
    }

    fn left_out(&self, point: &PointJob, setup: &Setup, reason: &Warning) -> Record {
        let mut record = Record { spp: point.spp, ..Record::of(setup) };
        record.warn(reason);
        self.label(point, record)
    }

    /// The rows of a curve. A round that ends inside a block of samples would render and time samples twice. An image
    /// with fewer samples than a block is therefore rendered separately; from there on one render grows.
    fn curve(&self, lab: &Lab, references: Option<&[Image; 2]>) -> Result<Vec<Record>> {
        let rounds = |spp: u32| Rounds::new(self.setup(lab, spp)?);
        let mut long = rounds(self.settings.spp)?;
        let mut rows = Vec::new();
        for point in &self.points {
            let mut short = if point.spp < SAMPLE_BLOCK { Some(rounds(point.spp)?) } else { None };
            let growing = short.as_mut().unwrap_or(&mut long);
            growing.extend_to(point.spp, None)?;
            rows.push(self.row(point, growing.setup(), &growing.outcome(), references)?);
        }
        Ok(rows)
    }

    fn other_program(
        &self,
        lab: &Lab,
        external: &External,
        folder: &Path,
        references: Option<&[Image; 2]>,
    ) -> Result<Vec<Record>> {
        let own = tempfile::tempdir().map_err(|e| Error::system("making", "a temporary folder", e))?;
        let (spec, out) = (&self.settings.spec, own.path().join(format!("image.{}", external.format())));
        let scene = lab.load_scene(&self.settings.scene)?;
        self.scene.check(&scene.hash)?;
        let values = [
            ("spp", self.settings.spp.to_string()),
            ("seed", spec.seed.to_string()),
            ("out", out.display().to_string()),
            ("width", spec.width.to_string()),
            ("height", spec.height.to_string()),
            ("folder", folder.display().to_string()),
        ];
        let found = run_external(&external.name, &filled(&external.command, &values), &out)?;
        let row = |point: &PointJob| {
            let Some(run) = &found else {
                return Ok(self.label(point, missing_external(&self.settings, &scene)));
            };
            let (size, found) = ([spec.width, spec.height], [run.image.width, run.image.height]);
            if size != found {
                let problem =
                    format!("is the size of the other program's image, which must be {}x{}", size[0], size[1]);
                return Err(InputError::new("size", format!("{}x{}", found[0], found[1]), problem).into());
            }
            if let Some(path) = &point.image {
                image_io::write(path, &run.image)?;
            }
            let mut record = run.record(&self.settings, &scene);
            if let Some(halves) = references {
                record = record.with_errors(&run.image, halves)?;
            }
            Ok(self.label(point, record))
        };
        self.points.iter().map(row).collect()
    }

    /// The rows of a cell that several processes render; each point starts new processes.
    fn by_processes(&self, lab: &Lab, ranks: u16) -> Result<Vec<Record>> {
        let row = |point: &PointJob| {
            let job = Self { points: vec![point.clone()], ..self.clone() };
            match run_processes(&job, ranks)? {
                Some(mut rows) => rows.pop().ok_or_else(|| Error::Check(format!("{ranks} processes gave no row"))),
                None => Ok(self.left_out(point, &self.setup(lab, point.spp)?, &Warning::NoProgram)),
            }
        };
        self.points.iter().map(row).collect()
    }

    /// Renders with the other processes that the launcher started. Rank 0 returns the row of the point, the others none.
    fn run_as_rank(&self, lab: &Lab) -> Result<Vec<Record>> {
        let rule = lab.rank_rule("rank-rule", self.settings.rank_rule.as_deref().unwrap_or_default())?;
        let settings = Settings { ranks: None, rank_rule: None, ..self.settings.clone() };
        let (alone, mut rows) = (Self { settings, ..self.clone() }, Vec::new());
        for point in &self.points {
            let setup = alone.setup(lab, point.spp)?;
            let cluster = Cluster::begin(None)?;
            let halves = self.references.as_ref().filter(|_| cluster.is_first());
            let references = halves.map(|halves| self.read_references(halves)).transpose()?;
            let Some((outcome, tally)) = cluster.render(&setup, &rule)? else { continue };
            self.trace.as_ref().map_or(Ok(()), |path| TraceFile::new(&setup, &outcome).write(path))?;
            let mut row = self.row(point, &setup, &outcome, references.as_ref())?;
            tally.label(&rule, &mut row);
            row.merge_s = row.merge_s.map(|merge_s| merge_s + tally.gather_s);
            rows.push(row);
        }
        Ok(rows)
    }

    fn row(
        &self,
        point: &PointJob,
        setup: &Setup,
        outcome: &Outcome,
        references: Option<&[Image; 2]>,
    ) -> Result<Record> {
        let image = outcome.film.image();
        let begun = Instant::now();
        let notes = || outcome.provenance(setup).notes();
        point.image.as_ref().map_or(Ok(()), |path| image_io::write_with_notes(path, &image, &notes()))?;
        let image_write_s = point.image.as_ref().map(|_| begun.elapsed().as_secs_f64());
        let mut record = Record { image_write_s, ..Record::new(setup, outcome) };
        if let Some(halves @ [first, second]) = references {
            record = record.with_errors(&image, halves)?;
            if let Some(object) = &self.object {
                let wanted = object_pixels(setup, object)?;
                let [image, first, second] = [&image, first, second].map(|image| only(image, &wanted));
                record.object_mse = Some(cross_mse(&image, &first, &second)?);
            }
        }
        Ok(self.label(point, record))
    }

    fn read_references(&self, halves: &[HalfFile; 2]) -> Result<[Image; 2]> {
        let read = |HalfFile { path, checksum }: &HalfFile| {
            let (key, film) = read_film(path)?;
            if film.checksum() != *checksum {
                let problem = "has changed since the experiment began";
                return Err(Error::from(InputError::new("film", path.display().to_string(), problem)));
            }
            Ok((key.seed, film.image()))
        };
        let [(first_seed, first), (second_seed, second)] = [read(&halves[0])?, read(&halves[1])?];
        let seed = self.settings.spec.seed;
        if first_seed == second_seed || [first_seed, second_seed].contains(&seed) {
            let problem = "the image and its two half-references must have three different seeds";
            return Err(InputError::new("seed", seed.to_string(), problem).into());
        }
        Ok([first, second])
    }
}

/// The error of a process that ended without an answer.
pub(super) fn ended(status: ExitStatus, said: &str) -> String {
    format!("the cell's process ended with {status}: {said}")
}

/// The child's side: reads a job and prints its rows. A process that a launcher of ranks started reads it from a file.
pub fn child_main(lab: &Lab, file: Option<&Path>) -> Result<()> {
    let read = |text: &str, from: &str| -> Result<CellJob> {
        let problem = |e| format!("is not the description of a cell: {e}");
        serde_json::from_str(text).map_err(|e| InputError::new(from, "", problem(e)).into())
    };
    if let Some(path) = file {
        let rows = read(&read_text(path)?, &path.display().to_string())?.run_as_rank(lab)?;
        return if rows.is_empty() { Ok(()) } else { write_answer(&rows) };
    }
    let mut text = String::new();
    std::io::stdin().read_line(&mut text).map_err(|e| Error::system("reading", "standard input", e))?;
    let job = read(&text, "standard input")?;
    let (tell, told) = channel();
    let listen = move || {
        // The parent's lines end when it is gone.
        for _ in std::io::stdin().lines().map_while(std::result::Result::ok) {
            tell.send(()).ok();
        }
        process_group::end_own_group();
    };
    let started = std::thread::Builder::new().spawn(listen);
    started.map_err(|e| Error::system("starting", "the thread that waits for the parent's end", e))?;
    let mut kept = None;
    write_answer(&job.run(lab, &mut kept)?)?;
    while job.stays && told.recv().is_ok() {
        write_answer(&job.run_again(lab, &mut kept)?)?;
    }
    Ok(())
}

fn write_answer(rows: &[Record]) -> Result<()> {
    let answer = serde_json::to_string(rows).map_err(|e| Error::system("writing", "standard output", e.into()))?;
    writeln!(std::io::stdout(), "{answer}").map_err(|e| Error::system("writing", "standard output", e))
}
