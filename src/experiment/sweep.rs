//! Runs the cells of an experiment, a row at a time.

use super::against::{Against, check_program, folder_against};
use super::calibration_file::write_calibration;
use super::cell::trace_file;
use super::instructions;
use super::object_pixels::check_object;
use super::processes::{MESSAGES, write_messages};
use super::records_file::RecordsFile;
use super::run_file::{RunFile, read_run_file};
use super::running::Running;
use super::shuffle::shuffled;
use super::sweep_shard::SweepShard;
use super::until::{MOST_REPETITIONS, Until};
use super::{
    Cell, CellJob, CellPoint, Definition, HalfFile, Keep, PointJob, Profile, Progress, Reference, render_reference,
    wanted_references,
};
use crate::atomic_file;
use crate::digest;
use crate::error::{Error, InputError, Result};
use crate::files::Files;
use crate::film::Film;
use crate::measure::{Doubts, Machine, Record, Settings, check_cache};
use crate::temporary;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What a sweep writes into its folder, beside images and traces.
const OWN_FILES: [&str; 6] =
    ["records.csv", "machine.toml", "experiment.toml", "calibration.csv", MESSAGES, instructions::INSTRUCTIONS];

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
    /// Until enough is known, if not as the definition says.
    pub until: Option<Until>,
    /// Cells with doubtful rows are run again.
    pub rerun_doubtful: bool,
    /// The instructions of each cell are counted besides.
    pub count_instructions: bool,
    /// Folder in which cells look for hierarchies of large scenes, and keep them.
    pub cache: Option<PathBuf>,
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
    pub(super) until: Option<Until>,
}

impl<'a> Sweep<'a> {
    /// Checks an experiment and enters its files into those of the command.
    pub fn new(definition: &'a Definition, options: &'a Options, files: &mut Files) -> Result<Self> {
        let cells = filtered(&definition.cells(options.profile)?, options)?;
        let mut cells = options.shard.map_or_else(|| Ok(cells.clone()), |shard| shard.cells(cells.clone()))?;
        if options.say_how_often() {
            for cell in &mut cells {
                cell.at_most = None;
            }
        }
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
        if options.count_instructions {
            instructions::check_counter()?;
        }
        files.reads("the experiment", Path::new(&definition.file));
        for cell in &cells {
            files.reads_scene(&cell.scene.files);
        }
        let folder = options.out.join(&definition.name);
        for name in OWN_FILES {
            files.claims("out", &folder.join(name))?;
        }
        let until = Until::of(definition, options)?;
        Ok(Self { definition, options, cells, references, until })
    }

    /// Runs what is not yet in the folder. Each repetition visits all cells once, in an order of its own.
    pub fn run(&self, progress: &dyn Progress) -> Result<Summary> {
        let Self { definition, options, cells, references: wanted, until } = self;
        let folder = options.out.join(&definition.name);
        let run = || run_file(definition, options, until.as_ref());
        let (file, done) = open(definition, options, &run(), &folder)?;
        let other = options.against.as_deref();
        let against = other
            .map(|program| Against::open(program, &options.out, &definition.name, &definition.text, run()))
            .transpose()?;

        let calibration = folder.join("calibration.csv");
        if definition.keeps(Keep::Calibration) && !calibration.is_file() {
            progress.note("calibrating: every strategy hands out empty jobs");
            write_calibration(&definition.lab, &calibration)?;
        }
        let messages = folder.join(MESSAGES);
        if definition.keeps(Keep::Messages) && !messages.is_file() && !write_messages(&messages)? {
            progress.note("there is no mpiexec, so nobody knows what messages cost");
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

        let repetitions = self.repetitions()?;
        let rows = (file, done);
        let mut running = Running::new(self, folder, references, against, rows, progress);
        let total: u64 = cells.iter().map(|cell| cell.weight * u64::from(cell.repetitions(repetitions))).sum();
        let without_limit = cells.iter().filter(|cell| cell.at_most.is_none()).count();
        let (mut units, begun, mut open) = (0, Instant::now(), without_limit);
        progress.begin(&definition.name, total);
        for repetition in 0..repetitions {
            let mut undecided = match until {
                Some(until) if repetition > 0 && until.is_over(begun.elapsed()) => break,
                Some(until) => running.undecided(until.goal),
                None => (0..cells.len()).collect(),
            };
            undecided.retain(|index| repetition < cells[*index].repetitions(repetitions));
            let still = undecided.iter().filter(|index| cells[**index].at_most.is_none()).count();
            if until.is_some() && still < open {
                open = still;
                progress.note(&format!("{} of {without_limit} cells decided", without_limit - open));
            }
            for index in shuffled(cells.len(), &definition.name, repetition) {
                if undecided.contains(&index) {
                    running.cell(index, repetition)?;
                }
                units += if repetition < cells[index].repetitions(repetitions) { cells[index].weight } else { 0 };
                progress.advance(units);
            }
            if undecided.is_empty() {
                break;
            }
        }
        progress.end();
        if options.rerun_doubtful {
            self.rerun(&mut running, repetitions, progress)?;
        }
        let summary = running.finish()?;
        if options.count_instructions {
            self.count_instructions(&summary.folder, progress)?;
        }
        Ok(summary)
    }

    /// How often each cell is run; at most, where it is until something is known.
    pub(super) fn repetitions(&self) -> Result<u32> {
        let usual = || match &self.options.until {
            Some(_) => Ok(MOST_REPETITIONS),
            // At most so many, where the definition says until when.
            None => self.definition.repetitions(self.options.profile),
        };
        self.options.repetitions.map_or_else(usual, Ok)
    }

    /// Runs cells with doubtful rows again, each as often as it lacks a row without a doubt, in repetitions of their own. What is doubtful stays, and
    /// what is doubtful again is not run a third time.
    fn rerun(&self, running: &mut Running<'_>, wanted: u32, progress: &dyn Progress) -> Result<()> {
        let doubtful = running.doubtful(wanted);
        let first = running.next_repetition();
        let blocks = doubtful.iter().map(|(_, lack)| *lack).max().unwrap_or(0);
        let total = doubtful.iter().map(|(index, lack)| self.cells[*index].weight * u64::from(*lack)).sum();
        let mut units = 0;
        progress.begin(&format!("{}, what is doubtful again", self.definition.name), total);
        for block in 0..blocks {
            let open: HashSet<usize> =
                doubtful.iter().filter(|(_, lack)| *lack > block).map(|(index, _)| *index).collect();
            for index in shuffled(self.cells.len(), &self.definition.name, first + block) {
                if open.contains(&index) {
                    running.cell(index, first + block)?;
                    units += self.cells[index].weight;
                    progress.advance(units);
                }
            }
        }
        progress.end();
        Ok(())
    }

    /// What a cell's process is asked to do in a repetition, which is number `order` of the sweep.
    pub(super) fn job(
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
            settings: Settings { cache: self.options.cache.clone(), ..cell.settings.clone() },
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

/// What is said of the rows of a sweep on this machine.
fn run_file(definition: &Definition, options: &Options, until: Option<&Until>) -> RunFile {
    RunFile {
        command: options.command.clone(),
        profile: options.profile.name().to_string(),
        shard: options.shard.map(|shard| shard.to_string()),
        against: options.against.as_ref().map(|program| program.display().to_string()),
        until: until.map(|until| until.text.clone()),
        uncapped: options.say_how_often(),
        cached: options.cache.is_some(),
        definition_hash: digest::of_text(&definition.text),
        machine: Machine::look(),
    }
}

/// The rows' file, and the rows that are there.
fn open(
    definition: &Definition,
    options: &Options,
    run: &RunFile,
    folder: &Path,
) -> Result<(RecordsFile, Vec<Record>)> {
    let (rows, machine) = (folder.join("records.csv"), folder.join("machine.toml"));
    let describe = || {
        run.write(&machine)?;
        atomic_file::write(&folder.join("experiment.toml"), |out| out.write_all(definition.text.as_bytes()))
    };
    if options.resume && rows.is_file() {
        // Killed before its first row, a sweep may have left no machine.toml, and has nothing that must not be mixed.
        if RecordsFile::has_rows(&rows)? {
            read_run_file(&machine)?.check_same(run, &machine)?;
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
    for (option, path) in [("out", Some(&options.out)), ("cache", options.cache.as_ref())] {
        if let Some(path) = path.filter(|path| path.to_str().is_none()) {
            let problem = "is not UTF-8 text, which the cells of a sweep are told it in";
            return Err(InputError::new(option, path.to_string_lossy(), problem).into());
        }
    }
    options.cache.as_deref().map_or(Ok(()), check_cache)?;
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
