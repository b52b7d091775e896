//! Sweeps: check an experiment, then run its cells and append their rows.

use super::baseline::{Baseline, baseline_folder, check_program};
use super::cell::{trace_file, with_serial_runs};
use super::comparisons::Comparisons;
use super::instructions;
use super::object_pixels::check_object;
use super::pairs::USUAL_PAIRS;
use super::processes::{MESSAGES, write_messages};
use super::records_file::RecordsFile;
use super::run_file::{RunFile, read_run_file};
use super::running::Running;
use super::shuffle::shuffled;
use super::stopping_rule::{MOST_REPETITIONS, StoppingRule};
use super::time_limit::{Limits, TIMED_OUT};
use super::{
    Cell, CellJob, CellPoint, Definition, HalfFile, Keep, PointJob, Profile, Progress, Reference, SweepShard, Timeout,
    render_reference, wanted_references,
};
use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::files::Files;
use crate::film::Film;
use crate::measure::{CALIBRATIONS, LeftOut, Record, TimingConcerns, write_calibrations};
use crate::temporary;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The files that a sweep writes into its folder, besides images and traces.
const OWN_FILES: [&str; 6] =
    ["records.csv", "machine.toml", "experiment.toml", "calibration.csv", MESSAGES, instructions::INSTRUCTIONS];

/// The options with which an experiment is run: those of the command line.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// The parent of the experiment's folder and of the references' folder.
    pub out: PathBuf,
    pub profile: Profile,
    pub resume: bool,
    /// Repetitions of each cell; `None` for the definition's number.
    pub repetitions: Option<u32>,
    /// Filters `field=value,value...`: a cell is run if it has one of the values of each filter.
    pub filters: Vec<String>,
    /// Another build of the program, which also runs each repetition of each cell.
    pub baseline: Option<PathBuf>,
    /// The part of the cells to run; `None` for all.
    pub shard: Option<SweepShard>,
    /// The figure that compares with serial runs. Filters then keep the serial runs, and there must be at least one.
    pub serial_for: Option<&'static str>,
    /// The goal at which repetitions stop; `None` for the definition's.
    pub until: Option<StoppingRule>,
    /// The time limit of each cell; `None` for the definition's.
    pub timeout: Option<Timeout>,
    pub count_instructions: bool,
    pub command: String,
}

#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Summary {
    pub folder: PathBuf,
    pub rows: usize,
    /// Number of rows of the other build, if there is one.
    pub other_rows: usize,
    /// Rows that failed, of either build, checksum mismatches included.
    pub failed: usize,
    /// Failed rows whose cell was ended at its time limit.
    pub timed_out: usize,
    /// Samples that were NaN, infinite or negative, over all rows.
    pub invalid: u64,
    /// Rows that were not run, because the machine lacks what they need.
    pub left_out: LeftOut,
    pub doubts: TimingConcerns,
}

impl Summary {
    pub(super) fn add_failure(&mut self, error: &str) {
        self.failed += 1;
        self.timed_out += usize::from(error.starts_with(TIMED_OUT));
    }
}

/// An experiment that is ready to start: all user input has been checked, and no file has been made.
pub struct Sweep<'a> {
    pub(super) definition: &'a Definition,
    pub(super) options: &'a Options,
    pub(super) cells: Vec<Cell>,
    pub(super) references: Vec<Reference>,
    pub(super) until: Option<StoppingRule>,
    /// The cells that run side by side.
    pub(super) comparisons: Comparisons,
}

impl<'a> Sweep<'a> {
    /// Checks an experiment and adds its files to `files`, the files of the command.
    pub fn new(definition: &'a Definition, options: &'a Options, files: &mut Files) -> Result<Self> {
        // Rows of a build with more features can be read without them.
        if let Some((feature, takes)) = definition.missing_feature() {
            let error = InputError::new("requires", feature, "is missing from this build");
            return Err(definition.located(options.profile, error.allowed(takes)));
        }
        let all = definition.cells(options.profile)?;
        let compared = Comparisons::of(definition, options.profile, &all)?;
        compared.check(definition, options.profile)?;
        let cells = compared.with_partners(&all, &filtered(&all, options)?);
        let mut cells = match options.shard {
            Some(shard) => compared.with_partners(&all, &shard.cells(&cells)?),
            None => cells,
        };
        let comparisons = Comparisons::of(definition, options.profile, &cells)?;
        if options.say_how_often() {
            for cell in &mut cells {
                cell.at_most = None;
            }
        }
        if let Some(figure) = options.serial_for.filter(|_| !cells.iter().any(|cell| cell.settings.is_serial())) {
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
        if let Some(program) = &options.baseline {
            check_program("baseline", program)?;
            let rows = baseline_folder(&options.out, &definition.name).join("records.csv");
            files.claims("out", &rows)?;
            if rows.exists() {
                let error = InputError::new("out", rows.display().to_string(), "already exists");
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
        let until = StoppingRule::of(definition, options)?;
        Ok(Self { definition, options, cells, references, until, comparisons })
    }

    /// Runs the repetitions of cells that have no rows yet. Each repetition visits all cells once, in a different
    /// order.
    pub fn run(&self, progress: &dyn Progress) -> Result<Summary> {
        let Self { definition, options, cells, references: wanted, until, comparisons } = self;
        let folder = options.out.join(&definition.name);
        let run = self.run_file()?;
        let (file, done) = open(definition, options, &run, &folder)?;
        let other = options.baseline.as_deref();
        let baseline = other
            .map(|program| Baseline::open(program, &options.out, &definition.name, &definition.text, run.clone()))
            .transpose()?;

        let calibration = folder.join("calibration.csv");
        if definition.keeps(Keep::Calibration) && !calibration.is_file() {
            progress.note("calibrating: every strategy hands out empty jobs");
            write_calibrations(&definition.lab, &calibration, CALIBRATIONS / 2)?;
        }
        let messages = folder.join(MESSAGES);
        if definition.keeps(Keep::Messages) && !messages.is_file() && !write_messages(&messages)? {
            progress.note("there is no mpiexec, so the costs of messages are not measured");
        }
        let references = references(definition, wanted, options, progress)?;
        let programs = folder.join("external");
        for external in &definition.external {
            std::fs::create_dir_all(&programs).map_err(|e| Error::system("creating", &programs, e))?;
            external.make(&programs, progress);
        }
        let (images, traces) = (folder.join("images"), folder.join("traces"));
        // A killed sweep may have left temporary files even in folders to which this one writes nothing.
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
        let mut running =
            Running::new(self, folder, references, baseline, rows, (Limits::of(self)?, self.pairs()?), progress);
        let total: u64 = cells.iter().map(|cell| cell.weight * u64::from(cell.repetitions(repetitions))).sum();
        let groups = if other.is_some() { Vec::new() } else { comparisons.groups(cells.len()) };
        let grouped: HashSet<usize> = groups.iter().flatten().copied().collect();
        let alone = (0..cells.len()).filter(|index| !grouped.contains(index)).map(|index| vec![index]);
        let blocks: Vec<Vec<usize>> = alone.chain(groups.iter().cloned()).collect();
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
                progress
                    .note(&format!("{} of {without_limit} cells decided: they reached the goal", without_limit - open));
            }
            let open_now: HashSet<usize> = undecided.iter().copied().collect();
            for block in shuffled(blocks.len(), &definition.name, repetition) {
                let open_of: Vec<usize> =
                    blocks[block].iter().copied().filter(|index| open_now.contains(index)).collect();
                match open_of.as_slice() {
                    [] => {}
                    [index] if other.is_none() || cells[*index].points.len() > 1 => running.cell(*index, repetition)?,
                    several => running.side_by_side(several, repetition)?,
                }
                let is_due = |index: &&usize| repetition < cells[**index].repetitions(repetitions);
                units += blocks[block].iter().filter(is_due).map(|index| cells[*index].weight).sum::<u64>();
                progress.advance(units);
            }
            if undecided.is_empty() {
                break;
            }
        }
        progress.end();
        if let Some(stage) = self.second_stage()? {
            self.run_second_stage(stage, (repetitions, begun), &mut running, progress)?;
        }
        if let Some(missed) = running.missed_goals() {
            progress.note(&missed);
        }
        if definition.keeps(Keep::Calibration) {
            progress.note("calibrating again: the difference shows how well the costs are known");
            write_calibrations(&definition.lab, &calibration, CALIBRATIONS)?;
        }
        let summary = running.finish()?;
        if options.count_instructions {
            self.count_instructions(&summary.folder, progress)?;
        }
        Ok(summary)
    }

    /// The pairs of a process, where cells run side by side.
    pub(super) fn pairs(&self) -> Result<u32> {
        Ok(self.definition.pairs(self.options.profile)?.unwrap_or(USUAL_PAIRS))
    }

    /// The repetitions of each cell; the largest number, if there is a goal.
    pub(super) fn repetitions(&self) -> Result<u32> {
        let usual = || match &self.options.until {
            Some(_) => Ok(MOST_REPETITIONS),
            // The largest number, if the definition has a goal.
            None => self.definition.repetitions(self.options.profile),
        };
        self.options.repetitions.map_or_else(usual, Ok)
    }

    /// The job of a cell's process in a repetition; `order` is its position in the sweep.
    pub(super) fn job(
        &self,
        cell: &Cell,
        (repetition, order): (u32, u64),
        folder: &Path,
        references: &[(&Reference, [HalfFile; 2])],
        lowest_seed: Option<u64>,
    ) -> CellJob {
        let definition = self.definition;
        // Curves have many images, so only those of the lowest seed are kept.
        let shown = cell.points.len() == 1 || Some(cell.settings.spec.seed) == lowest_seed;
        let is_kept = definition.keeps(Keep::Images) && repetition == 0 && shown;
        let point_job = |point: &CellPoint| PointJob {
            cell: point.id.clone(),
            spp: point.spp,
            image: is_kept.then(|| folder.join("images").join(point.image_file())),
        };
        let trace = || folder.join("traces").join(trace_file(&cell.id, repetition));
        let halves = references.iter().find(|(of, _)| of.is_for(cell)).map(|(_, halves)| halves.clone());
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
            stays: false,
        }
    }
}

/// The cells that pass all filters, and the serial runs with which their times are compared.
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
    Ok(with_serial_runs(cells, &wanted, options.serial_for.is_some()))
}

/// Creates or reopens the file of rows; also returns the rows that it already has.
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
        // A sweep killed before its first row may have left no machine.toml; without rows there is nothing to mix.
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

/// Refuses a new sweep in a non-empty folder without rows: files of the same names would be overwritten.
fn check_new(folder: &Path, rows: &Path) -> Result<()> {
    let Ok(mut entries) = std::fs::read_dir(folder) else { return Ok(()) };
    match entries.find_map(std::result::Result::ok) {
        Some(entry) if !rows.exists() => {
            let problem = format!("contains {}, but no rows of a sweep", entry.file_name().display());
            Err(InputError::new("out", folder.display().to_string(), problem).allowed("another --out").into())
        }
        _ => Ok(()),
    }
}

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

/// Refuses paths that cannot be passed to a cell's process, and names that no file can have.
fn check_names(definition: &Definition, options: &Options, cells: &[Cell]) -> Result<()> {
    if options.out.to_str().is_none() {
        let problem = "is not UTF-8 text, which the processes of cells require";
        return Err(InputError::new("out", options.out.to_string_lossy(), problem).into());
    }
    for cell in cells {
        if definition.keeps(Keep::Traces) {
            // No repetition number is longer.
            atomic_file::check_name(Path::new(&trace_file(&cell.id, u32::MAX)))?;
        }
        if definition.keeps(Keep::Images) {
            cell.points.iter().try_for_each(|point| atomic_file::check_name(Path::new(&point.image_file())))?;
        }
    }
    Ok(())
}
