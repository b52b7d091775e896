//! Runs the cells of an experiment, a row at a time.

use super::against::{Against, check_program, folder_against};
use super::calibration_file::write_calibration;
use super::cell::trace_file;
use super::drift::Drift;
use super::object_pixels::check_object;
use super::records_file::RecordsFile;
use super::run_file::{RunFile, read_run_file};
use super::shuffle::shuffled;
use super::sweep_shard::SweepShard;
use super::{
    Cell, CellJob, CellPoint, Definition, HalfFile, Keep, PointJob, Profile, Progress, Reference, render_reference,
    wanted_references,
};
use crate::atomic_file;
use crate::digest;
use crate::error::{Error, InputError, Result};
use crate::files::Files;
use crate::film::Film;
use crate::measure::{Doubts, Machine, Record};
use crate::temporary;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// What a sweep writes into its folder, beside images and traces.
const OWN_FILES: [&str; 4] = ["records.csv", "machine.toml", "experiment.toml", "calibration.csv"];

/// How to run an experiment.
#[derive(Debug, Clone)]
pub struct Options {
    /// Folder that gets a folder for the experiment, and one for references.
    pub out: PathBuf,
    /// How large.
    pub profile: Profile,
    /// Goes on with rows that are there.
    pub resume: bool,
    /// Repetitions, if not the definition's.
    pub repetitions: Option<u32>,
    /// `field=value,value...`: only cells that have one of the values of each.
    pub filters: Vec<String>,
    /// Another build of the program, which runs each repetition of each cell besides.
    pub against: Option<PathBuf>,
    /// The part of the cells to run, if not all.
    pub shard: Option<SweepShard>,
    /// The figure that compares with serial runs: filters leave them in, and there must be one.
    pub serial_for: Option<&'static str>,
    /// The command as the user gave it.
    pub command: String,
}

/// What a sweep did.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Summary {
    /// Where the rows are.
    pub folder: PathBuf,
    /// Rows in all.
    pub rows: usize,
    /// Rows that failed, checksum mismatches included.
    pub failed: usize,
    /// Samples that were NaN, infinite or negative, over all rows.
    pub invalid: u64,
    /// Rows whose times are in doubt.
    pub doubts: Doubts,
}

/// An experiment that can start: everything that the user could have got wrong has been checked, and nothing has been made.
pub struct Sweep<'a> {
    pub(super) definition: &'a Definition,
    pub(super) options: &'a Options,
    pub(super) cells: Vec<Cell>,
    pub(super) references: Vec<Reference>,
}

impl<'a> Sweep<'a> {
    /// Checks an experiment and enters its files into those of the command.
    pub fn new(definition: &'a Definition, options: &'a Options, files: &mut Files) -> Result<Self> {
        let cells = filtered(&definition.cells(options.profile)?, options)?;
        let cells = options.shard.map_or_else(|| Ok(cells.clone()), |shard| shard.cells(cells.clone()))?;
        if let Some(figure) = options.serial_for.filter(|_| !cells.iter().any(Cell::is_serial)) {
            let error = InputError::new("strategy", "", format!("the figure `{figure}` compares with serial runs"));
            return Err(definition.located(options.profile, error.allowed("serial beside the other strategies")));
        }
        check_names(definition, options, &cells)?;
        let references = wanted_references(definition, options.profile, &cells)?;
        for reference in &references {
            reference.check(&definition.lab).map_err(|error| definition.reference_error(options.profile, error))?;
            reference.check_cache(&definition.lab, &options.out.join("references"))?;
        }
        if let Some(object) = definition.object() {
            for cell in &cells {
                let checked =
                    definition.lab.prepare(cell.settings.clone()).and_then(|setup| check_object(&setup, object));
                checked.map_err(|error| definition.reference_error(options.profile, error))?;
            }
        }
        if let Some(program) = &options.against {
            check_program(program)?;
            let rows = folder_against(&options.out, &definition.name).join("records.csv");
            files.claims("out", &rows)?;
            if rows.exists() {
                let error = InputError::new("out", rows.display().to_string(), "is there already");
                return Err(error.allowed("another --out").into());
            }
        }
        files.reads("the experiment", Path::new(&definition.file));
        for cell in &cells {
            files.reads_scene(&cell.scene.files);
        }
        let folder = options.out.join(&definition.name);
        for name in OWN_FILES {
            files.claims("out", &folder.join(name))?;
        }
        Ok(Self { definition, options, cells, references })
    }

    /// Runs what is not yet in the folder. Each repetition visits all cells once, in an order of its own.
    pub fn run(&self, progress: &dyn Progress) -> Result<Summary> {
        let Self { definition, options, cells, references: wanted } = self;
        let folder = options.out.join(&definition.name);
        let (mut file, done) = open(definition, options, &folder)?;
        let other = options.against.as_deref();
        let run = || run_file(definition, options);
        let mut against = other
            .map(|program| Against::open(program, &options.out, &definition.name, &definition.text, run()))
            .transpose()?;

        let calibration = folder.join("calibration.csv");
        if definition.keeps(Keep::Calibration) && !calibration.is_file() {
            progress.note("calibrating: every strategy hands out empty jobs");
            write_calibration(&definition.lab, &calibration)?;
        }
        let references = references(definition, wanted, options, progress)?;
        let programs = folder.join("external");
        for external in &definition.external {
            std::fs::create_dir_all(&programs).map_err(|e| Error::system("creating", &programs, e))?;
            external.make(&programs, progress);
        }
        let (images, traces) = (folder.join("images"), folder.join("traces"));
        // Killed sweeps leave temporary files also where this one has nothing more to write.
        for folder in [&folder, &images, &traces, &options.out.join("references")] {
            temporary::remove_abandoned(folder);
        }
        for (wanted, folder) in [(Keep::Images, &images), (Keep::Traces, &traces)] {
            if definition.keeps(wanted) {
                std::fs::create_dir_all(folder).map_err(|e| Error::system("creating", folder, e))?;
            }
        }

        let mut checksums: HashMap<String, String> = HashMap::new();
        let points = cells.iter().flat_map(|cell| &cell.points);
        let known: HashMap<&str, &str> = points.map(|point| (point.id.as_str(), point.image.as_str())).collect();
        for record in &done {
            if let Some(image) = known.get(record.cell.as_str()) {
                checksums.entry((*image).to_string()).or_insert_with(|| record.checksum.clone());
            }
        }
        let finished: HashSet<(&str, u32)> =
            done.iter().map(|record| (record.cell.as_str(), record.repetition)).collect();
        let repetitions = options.repetitions.map_or_else(|| definition.repetitions(options.profile), Ok)?;
        let total: u64 = cells.iter().map(|cell| cell.weight).sum::<u64>() * u64::from(repetitions);
        let lowest_seed = cells.iter().map(|cell| cell.settings.spec.seed).min();
        let invalid = done.iter().filter_map(|record| record.invalid_samples).sum();
        let doubts = Doubts::of(done.iter().map(|record| record.warnings.as_str()));
        let mut summary = Summary { folder: folder.clone(), rows: done.len(), failed: 0, invalid, doubts };
        let mut drift = Drift::of(&done);
        let mut units = 0;
        // Rows that failed are gone and their numbers with them, so the count of rows may be taken already.
        let mut order = done.iter().map(|record| record.order + 1).max().unwrap_or(0);
        progress.begin(&definition.name, total);
        for repetition in 0..repetitions {
            for index in shuffled(cells.len(), &definition.name, repetition) {
                let cell = &cells[index];
                let is_missing = |id: &str| !finished.contains(&(id, repetition));
                if cell.points.iter().any(|point| is_missing(&point.id)) {
                    let job = self.job(cell, (repetition, order), &folder, &references, lowest_seed);
                    let mut run_against = |job: &CellJob| -> Result<()> {
                        for problem in against.as_mut().map_or(Ok(Vec::new()), |against| against.run(job))? {
                            summary.failed += 1;
                            progress.note(&format!("{} repetition {repetition}, the other build: {problem}", cell.id));
                        }
                        Ok(())
                    };
                    let other_first = (u64::from(repetition) + index as u64) % 2 == 1;
                    if other_first {
                        run_against(&job)?;
                    }
                    // A curve that was killed among its rows is rendered again, and only the rows that are not there are added.
                    let rows = job.run_in_child();
                    if !other_first {
                        run_against(&job)?;
                    }
                    let rows = cell.points.iter().zip(rows).filter(|(point, _)| is_missing(&point.id));
                    for (point, record) in rows {
                        let mut record = verified(Record { order, ..record }, &point.image, &mut checksums);
                        drift.watch(&mut record);
                        if !record.error.is_empty() {
                            summary.failed += 1;
                            progress.note(&format!("{} repetition {repetition}: {}", point.id, record.error));
                        }
                        file.append(&record)?;
                        summary.invalid += record.invalid_samples.unwrap_or(0);
                        summary.doubts.add(&record.warnings);
                        summary.rows += 1;
                        order += 1;
                    }
                }
                units += cell.weight;
                progress.advance(units);
            }
        }
        progress.end();
        file.check_own()?;
        Ok(summary)
    }
    /// What a cell's process is asked to do in a repetition, which is number `order` of the sweep.
    fn job(
        &self,
        cell: &Cell,
        (repetition, order): (u32, u64),
        folder: &Path,
        references: &[(&Reference, [HalfFile; 2])],
        lowest_seed: Option<u64>,
    ) -> CellJob {
        let definition = self.definition;
        // Curves have many images: those of one seed show what there is to see.
        let shown = cell.points.len() == 1 || Some(cell.settings.spec.seed) == lowest_seed;
        let is_kept = definition.keeps(Keep::Images) && repetition == 0 && shown;
        let point_job = |point: &CellPoint| PointJob {
            cell: point.id.clone(),
            spp: point.spp,
            image: is_kept.then(|| folder.join("images").join(point.image_file())),
        };
        let trace = || folder.join("traces").join(trace_file(&cell.id, repetition));
        let halves = references.iter().find(|(of, _)| of.is_for(&cell.settings)).map(|(_, halves)| halves.clone());
        CellJob {
            experiment: definition.name.clone(),
            points: cell.points.iter().map(point_job).collect(),
            repetition,
            order,
            settings: cell.settings.clone(),
            scene: cell.scene.clone(),
            references: halves,
            object: definition.object().map(str::to_string),
            external: cell.external.clone().map(|external| (external, folder.join("external"))),
            trace: definition.keeps(Keep::Traces).then(trace),
        }
    }
}

/// The cells that all filters let through, and the serial runs that their times are compared with.
fn filtered(cells: &[Cell], options: &Options) -> Result<Vec<Cell>> {
    let mut wanted: Vec<&Cell> = cells.iter().collect();
    for filter in &options.filters {
        let matches = wanted.iter().map(|cell| cell.matches(filter)).collect::<Result<Vec<bool>>>()?;
        let mut matches = matches.into_iter();
        wanted.retain(|_| matches.next().unwrap_or(false));
        if wanted.is_empty() {
            return Err(InputError::new("filter", filter, "leaves no cell to run").into());
        }
    }
    let is_wanted = |cell: &Cell| {
        let is_baseline = || wanted.iter().any(|other| cell.is_baseline_of(other));
        wanted.iter().any(|other| other.id == cell.id) || (options.serial_for.is_some() && is_baseline())
    };
    Ok(cells.iter().filter(|cell| is_wanted(cell)).cloned().collect())
}

/// A row whose checksum is not that of the other rows of the same image has failed: a schedule must not change a bit.
fn verified(record: Record, image: &str, checksums: &mut HashMap<String, String>) -> Record {
    if !record.error.is_empty() || record.checksum.is_empty() {
        return record;
    }
    let expected = checksums.entry(image.to_string()).or_insert_with(|| record.checksum.clone());
    if *expected == record.checksum {
        return record;
    }
    let error = format!("checksum {} instead of {expected}", record.checksum);
    Record { error, ..record }
}

/// What is said of the rows of a sweep on this machine.
fn run_file(definition: &Definition, options: &Options) -> RunFile {
    RunFile {
        command: options.command.clone(),
        profile: options.profile.name().to_string(),
        shard: options.shard.map(|shard| shard.to_string()),
        against: options.against.as_ref().map(|program| program.display().to_string()),
        definition_hash: digest::of_text(&definition.text),
        machine: Machine::look(),
    }
}

/// The rows' file, and the rows that are there.
fn open(definition: &Definition, options: &Options, folder: &Path) -> Result<(RecordsFile, Vec<Record>)> {
    let run = run_file(definition, options);
    let (rows, machine) = (folder.join("records.csv"), folder.join("machine.toml"));
    let describe = || {
        run.write(&machine)?;
        atomic_file::write(&folder.join("experiment.toml"), |out| out.write_all(definition.text.as_bytes()))
    };
    if options.resume && rows.is_file() {
        // Killed before its first row, a sweep may have left no machine.toml, and has nothing that must not be mixed.
        if RecordsFile::has_rows(&rows)? {
            read_run_file(&machine)?.check_same(&run, &machine)?;
        }
        let (file, done) = RecordsFile::resume(&rows)?;
        if done.is_empty() {
            describe()?;
        }
        return Ok((file, done));
    }
    check_new(folder, &rows)?;
    std::fs::create_dir_all(folder).map_err(|e| Error::system("creating", folder, e))?;
    let file = RecordsFile::create(&rows)?;
    describe()?;
    Ok((file, Vec::new()))
}

/// Refuses a folder of somebody else for a new sweep: what is in it would be overwritten by files of the same names.
fn check_new(folder: &Path, rows: &Path) -> Result<()> {
    let Ok(mut entries) = std::fs::read_dir(folder) else { return Ok(()) };
    match entries.find_map(std::result::Result::ok) {
        Some(entry) if !rows.exists() => {
            let problem = format!("is not empty, and no sweep wrote what is in it: {}", entry.file_name().display());
            Err(InputError::new("out", folder.display().to_string(), problem).allowed("another --out").into())
        }
        _ => Ok(()),
    }
}

/// The two halves of each reference.
fn references<'a>(
    definition: &Definition,
    wanted: &'a [Reference],
    options: &Options,
    progress: &dyn Progress,
) -> Result<Vec<(&'a Reference, [HalfFile; 2])>> {
    let folder = options.out.join("references");
    let render = |reference: &'a Reference| {
        std::fs::create_dir_all(&folder).map_err(|e| Error::system("creating", &folder, e))?;
        let half = |(path, film): (PathBuf, Film)| HalfFile { path, checksum: film.checksum() };
        let rendered = render_reference(&definition.lab, reference, &folder, progress)?;
        Ok((reference, rendered.map(half)))
    };
    wanted.iter().map(render).collect()
}

/// Refuses paths that no cell's process could be told, and names that no file can have.
fn check_names(definition: &Definition, options: &Options, cells: &[Cell]) -> Result<()> {
    if options.out.to_str().is_none() {
        let problem = "is not UTF-8 text, which the cells of a sweep are told it in";
        return Err(InputError::new("out", options.out.to_string_lossy(), problem).into());
    }
    for cell in cells {
        if definition.keeps(Keep::Traces) {
            // No repetition has a longer number.
            atomic_file::check_name(Path::new(&trace_file(&cell.id, u32::MAX)))?;
        }
        if definition.keeps(Keep::Images) {
            cell.points.iter().try_for_each(|point| atomic_file::check_name(Path::new(&point.image_file())))?;
        }
    }
    Ok(())
}
