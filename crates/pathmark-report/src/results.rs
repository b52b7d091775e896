//! Results of an experiment, read from its folder.

use super::naming::{Part, joined, needed};
use super::rows::{Row, by_process, gathered, group};
use super::schedule::{Schedule, over_ranks, strategy};
use crate::analysis::confidence_sequence::Stopping;
use crate::error::{InputError, Result};
use crate::experiment::{
    Definition, EXTERNAL, Profile, RunFile, read_records, read_run_file, records_path, trace_file, wanted_references,
};
use crate::film_file::read_film;
use crate::image_io::{self, Image};
use crate::input::read_text;
use crate::lab::Lab;
use crate::measure::{ImageKey, LeftOut, Record, SETTINGS, Setting, TimingConcerns, TraceFile};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An experiment's definition, machine and rows.
pub struct Results {
    /// The definition as it was run.
    pub definition: Definition,
    /// Command and machine.
    pub run: RunFile,
    pub failed: Vec<Record>,
    /// Rows that were not run, because the machine lacked what they need.
    pub left_out: LeftOut,
    pub folder: PathBuf,
    /// The folder that holds all experiments and the references.
    pub out: PathBuf,
    rows: Vec<Row>,
    doubts: TimingConcerns,
    /// The properties that distinguish series of images, beside samples and seed.
    image_parts: Vec<&'static Setting>,
}

impl Results {
    pub fn read(lab: &Arc<Lab>, out: &Path, folder: &Path) -> Result<Self> {
        let path = folder.join("experiment.toml");
        // The folder `.` has its name elsewhere.
        let whole =
            if folder.file_name().is_none() { folder.canonicalize().unwrap_or_default() } else { folder.to_path_buf() };
        let name = whole.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let definition = Definition::from_text(lab, &name, &path.display().to_string(), &read_text(&path)?)?;
        let run = read_run_file(&folder.join("machine.toml"))?;
        let path = records_path(folder);
        let records = read_records(&path)?;
        check_identities(&records, &path)?;
        let (mut done, failed): (Vec<Record>, Vec<Record>) = records.into_iter().partition(|row| row.error.is_empty());
        let left_out = LeftOut::of(&done);
        done.retain(|row| !row.is_left_out());
        name_scenes_alike(&mut done);
        let doubts = TimingConcerns::of(done.iter().map(|row| row.warnings.as_str()));
        let rows = by_process(named(done));
        let image_parts = image_parts(&rows);
        let (folder, out) = (folder.to_path_buf(), out.to_path_buf());
        Ok(Self { definition, run, failed, left_out, folder, out, rows, doubts, image_parts })
    }

    /// Reads an experiment's folder; its parent is the folder of all experiments.
    pub fn open(lab: &Arc<Lab>, folder: &Path) -> Result<Self> {
        let out = folder.parent().unwrap_or(Path::new(""));
        Self::read(lab, out, folder)
    }

    /// The rows that were run and did not fail. To call this once for each of many groups takes quadratic time; [`Results::by`]
    /// takes one pass.
    pub(super) fn rows(&self) -> impl Iterator<Item = &Row> + Clone {
        #[cfg(test)]
        super::tests::count_pass();
        self.rows.iter()
    }

    /// Rows by a key, in the order of the key.
    pub(super) fn by<'a, K: Ord>(&'a self, key: impl Fn(&'a Row) -> K) -> BTreeMap<K, Vec<&'a Row>> {
        group(self.rows(), key)
    }

    /// The rule that set the number of repetitions: fixed, or sequential with a goal.
    pub(super) fn stopping(&self) -> Stopping {
        if self.run.until.is_some() { Stopping::Sequential } else { Stopping::Fixed }
    }

    /// Doubts about the times of the file's rows that did not fail. Figures have the pairs of a process as one row.
    pub fn doubts(&self) -> TimingConcerns {
        self.doubts
    }

    /// Workers that can run at the same time, where cores of a slower kind count by their speed.
    pub(super) fn weight_in_use(&self, threads: usize) -> f64 {
        let machine = &self.run.machine;
        machine.layout.weight(threads.min(machine.processors))
    }

    /// A sentence about the weights of cores; empty if all are alike.
    pub(super) fn weights_in_words(&self) -> &'static str {
        if self.run.machine.layout.kinds.len() > 1 {
            " Cores of this machine differ in speed, so each counts by its capacity, the fastest first."
        } else {
            ""
        }
    }

    /// How many of the file's rows did not fail.
    pub(super) fn len(&self) -> usize {
        self.doubts.rows()
    }

    /// The first row, for properties that all rows share.
    pub(super) fn first(&self) -> Option<&Row> {
        self.rows.first()
    }

    /// The kept traces of the serial runs with the most jobs, of runs like the typical one.
    pub fn largest_serial_traces(&self) -> Result<Vec<TraceFile>> {
        let serial: Vec<&Row> = self.rows().filter(|row| row.schedule.is_serial()).collect();
        let most = serial.iter().map(|row| row.jobs).max();
        let rows: Vec<&Row> = serial.into_iter().filter(|row| Some(row.jobs) == most).collect();
        self.traces_like_typical(&rows)
    }

    /// The kept traces of the rows that have the image and the pieces of the typical row; its own trace comes first.
    pub(super) fn traces_like_typical(&self, rows: &[&Row]) -> Result<Vec<TraceFile>> {
        let Some(typical) = Self::typical(rows) else { return Ok(Vec::new()) };
        let is_like = |row: &Row| row.image == typical.image && row.decomposition == typical.decomposition;
        let others = rows.iter().copied().filter(|row| is_like(row) && !std::ptr::eq(*row, typical));
        std::iter::once(typical).chain(others).filter_map(|row| self.trace(row).transpose()).collect()
    }

    pub fn profile(&self) -> Profile {
        Profile::from_name(&self.run.profile).unwrap_or(Profile::Quick)
    }

    /// Scene, size and machine in a line, as the subtitle of a figure.
    pub(super) fn workload(&self) -> String {
        self.workload_of(&self.rows().collect::<Vec<&Row>>())
    }

    /// The same for some rows. Leaves out the scene if there are several, and the sizes if there are more than three.
    pub(super) fn workload_of(&self, rows: &[&Row]) -> String {
        let scenes: BTreeSet<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
        let sizes: BTreeSet<(u32, u32)> = rows.iter().map(|row| (row.width, row.height)).collect();
        let scene = scenes.first().filter(|_| scenes.len() == 1).map(|scene| format!("{scene}, "));
        let sizes: Vec<String> = sizes.into_iter().map(|(width, height)| format!("{width}x{height}")).collect();
        let size = (1..=3).contains(&sizes.len()).then(|| format!("{}, ", sizes.join(" and ")));
        format!("{}{}{}", scene.unwrap_or_default(), size.unwrap_or_default(), self.run.machine.line())
    }

    /// Width and height of the images.
    pub(super) fn size(&self) -> String {
        self.first().map_or_else(String::new, |row| format!("{}x{}", row.width, row.height))
    }

    /// The properties in which the experiment's images differ, apart from samples and seed; empty if they do not
    /// differ.
    pub(super) fn series_name(&self, row: &Row) -> String {
        joined(self.image_parts.iter().map(|setting| label(setting, row)))
    }

    /// [`Results::series_name`] among images of one scene.
    pub(super) fn series_name_in_scene(&self, row: &Row) -> String {
        joined(self.image_parts.iter().filter(|setting| setting.name != "scene").map(|setting| label(setting, row)))
    }

    /// The properties in which the images differ, or the estimator if they do not.
    pub(super) fn image_name(&self, row: &Row) -> String {
        let series = self.series_name(row);
        if series.is_empty() { row.estimator.clone() } else { series }
    }

    /// The trace of a row, if it was kept.
    pub(super) fn trace(&self, row: &Row) -> Result<Option<TraceFile>> {
        let path = self.trace_path(row);
        if path.is_file() { TraceFile::read(&path).map(Some) } else { Ok(None) }
    }

    fn trace_path(&self, row: &Row) -> PathBuf {
        self.folder.join("traces").join(trace_file(&row.cell, row.repetition))
    }

    /// The file with the calibrations of the schedules.
    pub(super) fn calibration_path(&self) -> PathBuf {
        self.folder.join("calibration.csv")
    }

    /// The kept files from which the schedules of a forecast are simulated: calibrations, and traces of serial rows.
    pub(super) fn files_of_forecasts(&self) -> Vec<PathBuf> {
        let serial = self.rows().flat_map(Row::runs).filter(|row| row.schedule.is_serial());
        let files = std::iter::once(self.calibration_path()).chain(serial.map(|row| self.trace_path(row)));
        files.filter(|path| path.is_file()).collect()
    }

    /// The kept images of the rows that `is_wanted` selects, in the order of the rows.
    pub(super) fn kept_images(&self, is_wanted: impl Fn(&Row) -> bool) -> Result<Vec<(&Row, Image)>> {
        let cells = self.definition.cells(self.profile())?;
        let points = cells.iter().flat_map(|cell| &cell.points);
        let files: HashMap<&str, String> = points.map(|point| (point.id.as_str(), point.image_file())).collect();
        let mut images = Vec::new();
        for row in self.rows().filter(|row| row.repetition == 0 && is_wanted(row)) {
            let path = files.get(row.cell.as_str()).map(|file| self.folder.join("images").join(file));
            if let Some(path) = path.filter(|path| path.is_file()) {
                images.push((row, image_io::read(&path)?));
            }
        }
        Ok(images)
    }

    /// The mean of the two half-references of a scene, by the name that rows have for it, or of the first scene; `None` if
    /// their files are missing, as in a copied folder.
    pub(super) fn reference_image(&self, scene: Option<&str>) -> Result<Option<Image>> {
        let profile = self.profile();
        let cells = self.definition.cells(profile)?;
        let hashes: Option<BTreeSet<&str>> = scene
            .map(|scene| self.rows().filter(|row| row.scene == scene).map(|row| row.scene_hash.as_str()).collect());
        let mut wanted = wanted_references(&self.definition, profile, &cells)?.into_iter();
        let of_scene =
            wanted.find(|wanted| hashes.as_ref().is_none_or(|own| own.iter().any(|hash| wanted.is_of(hash))));
        let Some(wanted) = of_scene else { return Ok(None) };
        let [first, second] = wanted.paths(&self.definition.lab, &self.out.join("references"))?;
        if !(first.is_file() && second.is_file()) {
            return Ok(None);
        }
        let ((_, first), (_, second)) = (read_film(&first)?, read_film(&second)?);
        let mut image = first.image();
        for (pixel, other) in image.pixels.iter_mut().zip(second.image().pixels) {
            *pixel = std::array::from_fn(|channel| 0.5 * (pixel[channel] + other[channel]));
        }
        Ok(Some(image))
    }

    /// The row with the median time; of two middle ones, the faster. It is a row of the image that most of the rows
    /// have, because times of different images have no common order.
    pub(super) fn typical<'a>(rows: &[&'a Row]) -> Option<&'a Row> {
        let timed = rows.iter().filter_map(|row| Some((row.makespan_s?, *row)));
        let images = gathered(timed.map(|timed| (&timed.1.image, timed))).into_values();
        let mut timed = images.rev().max_by_key(Vec::len)?;
        timed.sort_by(|a, b| a.0.total_cmp(&b.0));
        timed.get(timed.len().checked_sub(1)? / 2).map(|(_, row)| *row)
    }
}

/// Gives the rows of other programs the name that our own rows have for the same scene: a scene is known by its content,
/// and a file may be named by its path or by its stem.
fn name_scenes_alike(records: &mut [Record]) {
    let mut names: HashMap<String, Vec<String>> = HashMap::new();
    for record in records.iter().filter(|record| record.strategy != EXTERNAL) {
        let known = names.entry(record.scene_hash.clone()).or_default();
        if !known.contains(&record.scene) {
            known.push(record.scene.clone());
        }
    }
    for record in records.iter_mut().filter(|record| record.strategy == EXTERNAL) {
        if let Some(known) = names.get(&record.scene_hash).filter(|known| !known.contains(&record.scene)) {
            record.scene.clone_from(&known[0]);
        }
    }
}

/// Refuses rows that no axis distinguishes: in figures, one would silently replace the other.
fn check_identities(records: &[Record], path: &Path) -> Result<()> {
    let mut known = HashMap::new();
    for (index, record) in records.iter().enumerate().filter(|(_, record)| record.error.is_empty()) {
        let key = (record.image_key(), record.schedule_key(), record.repetition, record.pair);
        if let Some(other) = known.insert(key, &record.cell) {
            let problem = format!(
                "is the same image by the same schedule in the same repetition as {other}: nothing tells the two rows apart"
            );
            let at = Some((index + 2, 1));
            return Err(InputError::new("cell", &record.cell, problem).in_file(path.display().to_string(), at).into());
        }
    }
    Ok(())
}

/// Names the schedules of the rows: the strategy, and the other properties that distinguish schedules of the same
/// image.
fn named(records: Vec<Record>) -> Vec<Row> {
    let parts: [Part<Record>; 7] = [
        |record| record.output.clone(),
        Record::kernel_name,
        |record| if record.kernel_fallback.is_empty() { String::new() } else { "fallback".to_string() },
        |record| record.effects.clone(),
        |record| record.accelerator.clone(),
        |record| if record.pin.is_empty() { String::new() } else { format!("pin {}", record.pin) },
        |record| if record.counters { "with counters".to_string() } else { String::new() },
    ];
    let told = |record: &Record| {
        (
            record.image_key(),
            record.repetition,
            strategy(record).to_string(),
            record.decomposition.clone(),
            (record.threads, record.ranks, record.rank_rule.clone()),
        )
    };
    let parts = needed(&records.iter().collect::<Vec<_>>(), told, parts, |part, record| part(record));
    let row = |record: Record, as_written: Option<Record>| {
        let words = std::iter::once(strategy(&record).to_string()).chain(parts.iter().map(|part| part(&record)));
        let schedule = Schedule { name: joined(words), key: record.schedule_key() };
        Row::new(record, as_written.map(Box::new), schedule)
    };
    let rows = records.into_iter().map(|record| match over_ranks(&record) {
        Some(told) => row(told, Some(record)),
        None => row(record, None),
    });
    rows.collect()
}

/// A setting of a row's image, in words.
fn label(setting: &Setting, row: &Row) -> String {
    setting.label_of(&row.image, &row.schedule.key).unwrap_or_else(|| setting.absent.to_string())
}

/// The settings to name images by. Scene, estimator and sampler are named wherever they differ, the others only where
/// nothing else distinguishes two images.
fn image_parts(rows: &[Row]) -> Vec<&'static Setting> {
    let rows: Vec<&Row> = rows.iter().collect();
    let differs = |setting: &&Setting| rows.iter().any(|row| label(setting, row) != label(setting, rows[0]));
    let main = ["scene", "estimator", "sampler"].into_iter().filter_map(Setting::named).filter(differs);
    let told = |row: &Row| {
        let ImageKey { scene, scene_hash, estimator, sampler, spp, seed, .. } = row.image.clone();
        (scene, scene_hash, estimator, sampler, spp, seed)
    };
    let labelled = SETTINGS.iter().filter(|setting| setting.changes_image && setting.is_label());
    main.chain(needed(&rows, told, labelled, label)).collect()
}
