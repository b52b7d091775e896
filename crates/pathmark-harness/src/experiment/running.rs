//! A running sweep: runs cells, checks their rows and appends them.

use super::baseline::Baseline;
use super::comparisons::Comparison;
use super::drift::Drift;
use super::pairs::{Contestant, run_pairs};
use super::records_file::RecordsFile;
use super::stopping_rule::{Decisions, Goal, half_width};
use super::sweep::{Summary, Sweep};
use super::time_limit::Limits;
use super::{Cell, CellPoint, HalfFile, Progress, Reference};
use crate::error::Result;
use crate::measure::{LeftOut, Record, SETTINGS, Setting, Settings, TimingConcerns};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::PathBuf;

/// The state of a running sweep: the rows so far, and the files for the next ones.
pub(super) struct Running<'a> {
    sweep: &'a Sweep<'a>,
    folder: PathBuf,
    references: Vec<(&'a Reference, [HalfFile; 2])>,
    baseline: Option<Baseline>,
    file: RecordsFile,
    progress: &'a dyn Progress,
    finished: HashSet<(String, u32)>,
    /// The times of this build, and of the other one if there is one.
    decisions: Decisions,
    serial: Vec<Option<usize>>,
    /// The first row's checksum of each image.
    checksums: HashMap<String, String>,
    /// For each process, the first number that no pair has yet.
    first_pairs: HashMap<u32, u32>,
    drift: Drift,
    limits: Limits<'a>,
    lowest_seed: Option<u64>,
    /// Pairs of a process, where cells run side by side.
    pairs: u32,
    order: u64,
    /// The errors of failed rows, each of which is reported once.
    told: HashSet<String>,
    summary: Summary,
}

impl<'a> Running<'a> {
    pub(super) fn new(
        sweep: &'a Sweep<'a>,
        folder: PathBuf,
        references: Vec<(&'a Reference, [HalfFile; 2])>,
        baseline: Option<Baseline>,
        (file, done): (RecordsFile, Vec<Record>),
        (limits, pairs): (Limits<'a>, u32),
        progress: &'a dyn Progress,
    ) -> Self {
        let summary = Summary {
            folder: folder.clone(),
            rows: done.len(),
            left_out: LeftOut::of(&done),
            invalid: done.iter().filter_map(|record| record.invalid_samples).sum(),
            doubts: TimingConcerns::of(done.iter().map(|record| record.warnings.as_str())),
            ..Summary::default()
        };
        let mut running = Self {
            sweep,
            folder,
            references,
            baseline,
            file,
            progress,
            finished: HashSet::new(),
            decisions: Decisions::default(),
            serial: serial_runs(&sweep.cells),
            checksums: HashMap::new(),
            first_pairs: HashMap::new(),
            drift: Drift::of(&done),
            limits,
            pairs,
            lowest_seed: sweep.cells.iter().map(|cell| cell.settings.spec.seed).min(),
            // Failed rows were dropped with their numbers, so the number of rows may be in use already.
            order: done.iter().map(|record| record.run_order + 1).max().unwrap_or(0),
            told: HashSet::new(),
            summary,
        };
        let points = sweep.cells.iter().flat_map(|cell| &cell.points);
        let images: HashMap<&str, &str> = points.map(|point| (point.id.as_str(), point.image.as_str())).collect();
        for record in &done {
            if let Some(image) = images.get(record.cell.as_str()) {
                running.checksums.entry(image_of(record, image)).or_insert_with(|| record.checksum.clone());
            }
            running.note(record);
        }
        running
    }

    fn note(&mut self, record: &Record) {
        self.finished.insert((record.cell.clone(), record.repetition));
        let first = self.first_pairs.entry(record.repetition).or_default();
        *first = record.pair.map_or(*first, |pair| (*first).max(pair + 1));
        self.decisions.note(record, true);
    }

    pub(super) fn decisions(&self) -> &Decisions {
        &self.decisions
    }

    /// Runs a repetition of a cell and adds the rows that are missing.
    pub(super) fn cell(&mut self, index: usize, repetition: u32) -> Result<()> {
        let cell = &self.sweep.cells[index];
        let is_missing = |id: &str| !self.finished.contains(&(id.to_string(), repetition));
        let missing: Vec<bool> = cell.points.iter().map(|point| is_missing(&point.id)).collect();
        if !missing.contains(&true) {
            return Ok(());
        }
        let job = self.sweep.job(cell, (repetition, self.order), &self.folder, &self.references, self.lowest_seed);
        let limit = self.limits.limit(cell);
        let (mut others, other_first) = (Vec::new(), (u64::from(repetition) + index as u64) % 2 == 1);
        let mut run_baseline = || {
            self.baseline.as_mut().map_or(Ok(()), |baseline| baseline.run(&job, limit).map(|rows| others.extend(rows)))
        };
        if other_first {
            run_baseline()?;
        }
        // A curve that was killed between two rows is rendered again, and only the missing rows are added.
        let rows = job.run_in_child(None, limit);
        if !other_first {
            run_baseline()?;
        }
        self.note_others(&others);
        for ((point, record), _) in cell.points.iter().zip(rows).zip(missing).filter(|(_, is_missing)| *is_missing) {
            let record = self.checked(record, &point.image);
            self.file.append(&record)?;
        }
        Ok(())
    }

    /// Runs a process of each of these cells in adjacent pairs: with each other, and with the other build if there is one.
    pub(super) fn side_by_side(&mut self, members: &[usize], process: u32) -> Result<()> {
        let cells = &self.sweep.cells;
        let is_missing = |index: &usize| !self.finished.contains(&(cells[*index].points[0].id.clone(), process));
        if !members.iter().any(is_missing) {
            return Ok(());
        }
        // Rows that a resumed sweep lacks would have no run beside them, so all cells run again, in new pairs.
        let resumed = self.first_pairs.get(&process).copied().filter(|_| !members.iter().all(is_missing));
        let job = |index: usize, running: &Self| {
            let of = (process, running.order);
            running.sweep.job(&cells[index], of, &running.folder, &running.references, running.lowest_seed)
        };
        let own = std::env::current_exe().map_err(|e| format!("finding this program: {e}"));
        let mut group = Vec::new();
        for index in members {
            let limit = self.limits.limit(&cells[*index]);
            group.push(Contestant::new(job(*index, self), own.clone(), limit));
        }
        for index in members.iter().filter(|_| self.baseline.is_some()) {
            let limit = self.limits.limit(&cells[*index]);
            let program =
                self.baseline.as_ref().map(|baseline| baseline.program().to_path_buf()).ok_or_else(String::new);
            group.push(Contestant::new(Baseline::job(&job(*index, self)), program, limit));
        }
        let rows = run_pairs(&mut group, self.pairs, &self.sweep.definition.name, process);
        drop(group);
        let (mut owns, mut others, first) = (Vec::new(), Vec::new(), self.order);
        for (at, record) in rows {
            let record = Record { pair: record.pair.map(|pair| pair + resumed.unwrap_or(0)), ..record };
            match members.get(at) {
                Some(index) => owns.push(self.checked(record, &cells[*index].points[0].image)),
                // Both builds number their rows alike.
                None => others.push(Record { run_order: first + others.len() as u64, ..record }),
            }
        }
        self.file.append_all(&owns)?;
        self.note_others(&others);
        self.baseline.as_mut().map_or(Ok(()), |baseline| baseline.append(&others))
    }

    /// Records rows of the other build.
    fn note_others(&mut self, others: &[Record]) {
        self.summary.other_rows += others.len();
        for other in others {
            if !other.error.is_empty() {
                self.summary.add_failure(&other.error);
                let Record { cell, repetition, error, .. } = other;
                self.progress.note(&format!("{cell} repetition {repetition}, the other build: {error}"));
            }
            self.decisions.note(other, false);
        }
    }

    /// The row with its number and the results of all checks, for the file.
    fn checked(&mut self, record: Record, image: &str) -> Record {
        let record = Record { run_order: self.order, ..record };
        let image = image_of(&record, image);
        let mut record = verified(record, &image, &mut self.checksums);
        self.drift.watch(&mut record);
        if !record.error.is_empty() {
            self.summary.add_failure(&record.error);
            // A program that fails usually fails in every row.
            if self.told.insert(record.error.clone()) {
                self.progress.note(&format!("{} repetition {}: {}", record.cell, record.repetition, record.error));
            }
        }
        self.summary.left_out.add(&record);
        self.summary.invalid += record.invalid_samples.unwrap_or(0);
        self.summary.doubts.add(&record.warnings);
        self.summary.rows += 1;
        self.order += 1;
        self.note(&record);
        record
    }

    /// The comparisons whose interval is wider than their goal, in words.
    pub(super) fn missed_goals(&self) -> Option<String> {
        let (cells, comparisons) = (&self.sweep.cells, self.sweep.comparisons.over_seeds(&self.sweep.cells));
        let missed = comparisons.iter().filter_map(|seeds| {
            let Comparison { what, with, goal } = seeds.first()?;
            let ids = |pair: &Comparison| (cells[pair.what].id.as_str(), cells[pair.with].id.as_str());
            let found = self.decisions.paired(&seeds.iter().map(ids).collect::<Vec<_>>(), u32::MAX);
            let (half, goal) = (found.map_or(f64::INFINITY, |found| half_width(&found)), (*goal)?);
            (half > goal).then_some((half, goal, &cells[*what], &cells[*with]))
        });
        let mut missed: Vec<_> = missed.collect();
        missed.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (half, goal, what, with) = missed.first()?;
        let width = if half.is_finite() { format!("±{:.1} %", 100.0 * half) } else { "no interval".to_string() };
        let differing: Vec<&Setting> =
            SETTINGS.iter().filter(|setting| what.shown(setting) != with.shown(setting)).collect();
        let told = |cell: &Cell| differing.iter().map(|setting| cell.shown(setting)).collect::<Vec<_>>().join(" ");
        Some(format!(
            "{} of {} comparisons missed their precision; the widest is {} over {} on {}: {width} instead of ±{:.1} %",
            missed.len(),
            comparisons.iter().filter(|seeds| seeds[0].goal.is_some()).count(),
            told(what),
            told(with),
            what.settings.scene,
            100.0 * goal
        ))
    }

    pub(super) fn undecided(&self, goal: Goal) -> Vec<usize> {
        match goal {
            Goal::Share(limit) => self.unknown(limit),
            Goal::Fastest | Goal::Order => self.unordered(goal),
        }
    }

    /// The cells whose place among the schedules of their image is unknown, the serial runs beside them, and the cells
    /// that are not compared because their matrix limits their repetitions. A curve's last point is compared.
    fn unordered(&self, goal: Goal) -> Vec<usize> {
        let mut images: BTreeMap<&str, Vec<(usize, &str)>> = BTreeMap::new();
        let (compared, counted): (Vec<_>, Vec<_>) =
            self.sweep.cells.iter().enumerate().partition(|(_, cell)| cell.at_most.is_none());
        for (index, cell) in compared {
            if let Some(end) = cell.points.last() {
                images.entry(&end.image).or_default().push((index, &end.id));
            }
        }
        let ids: Vec<Vec<&str>> = images.values().map(|cells| cells.iter().map(|(_, id)| *id).collect()).collect();
        let open = self.decisions.open_schedules(&ids, goal);
        let cells = images.values().flatten().zip(open.into_iter().flatten());
        let open: Vec<usize> = cells.filter(|(_, is_open)| *is_open).map(|((index, _), _)| *index).collect();
        let beside = open.iter().filter_map(|own| self.serial[*own]);
        let all: BTreeSet<usize> =
            open.iter().copied().chain(beside).chain(counted.into_iter().map(|(index, _)| index)).collect();
        all.into_iter().collect()
    }

    /// The open cells, and the serial runs beside them. With two builds, a cell is open until its ratio is decided at
    /// the limit; with one build, until its speedup or time is known to within the limit.
    fn unknown(&self, limit: f64) -> Vec<usize> {
        let cells = &self.sweep.cells;
        let count = cells.iter().map(|cell| cell.points.len()).sum();
        let is_decided = |index: usize, point: &CellPoint| {
            if self.baseline.is_some() {
                return self.decisions.is_decided(&point.id, count, limit);
            }
            let serial = self.serial[index].map(|serial| &cells[serial].points);
            let beside = serial.and_then(|points| points.iter().find(|other| other.spp == point.spp));
            self.decisions.is_known(&point.id, beside.map(|other| other.id.as_str()), limit)
        };
        let compared = &self.sweep.comparisons.pairs;
        let is_side_by_side = |index: usize| compared.iter().any(|pair| pair.what == index || pair.with == index);
        let has_open_pair = |index: usize| {
            let own = compared.iter().filter(|pair| pair.what == index || pair.with == index);
            own.into_iter().any(|pair| {
                let [what, with] = [pair.what, pair.with].map(|at| cells[at].id.as_str());
                !self.decisions.is_paired(what, with, limit)
            })
        };
        let is_open = |index: usize| {
            if self.baseline.is_none() && is_side_by_side(index) {
                return has_open_pair(index);
            }
            cells[index].points.iter().any(|point| !is_decided(index, point))
        };
        let serial: HashSet<usize> = self.serial.iter().flatten().copied().collect();
        let serves_only = |index: usize| self.baseline.is_none() && serial.contains(&index) && !is_side_by_side(index);
        let open: HashSet<usize> = (0..cells.len()).filter(|index| !serves_only(*index) && is_open(*index)).collect();
        let beside: HashSet<usize> =
            open.iter().filter_map(|own| self.serial[*own]).filter(|own| serves_only(*own)).collect();
        (0..cells.len()).filter(|index| open.contains(index) || beside.contains(index)).collect()
    }

    /// The outcome, after a check that the file of rows is still this sweep's own.
    pub(super) fn finish(self) -> Result<Summary> {
        self.file.check_own()?;
        Ok(self.summary)
    }
}

/// The serial run of each cell's image, with the same decomposition if there is one. `None` for a serial cell.
fn serial_runs(cells: &[Cell]) -> Vec<Option<usize>> {
    let mut of_image: HashMap<Settings, Vec<usize>> = HashMap::new();
    for (index, cell) in cells.iter().enumerate().filter(|(_, cell)| cell.settings.is_serial()) {
        of_image.entry(cell.without_schedule()).or_default().push(index);
    }
    let serial_of = |own: &Cell| {
        let serial = of_image.get(&own.without_schedule()).filter(|_| !own.settings.is_serial())?;
        let is_on_its_pieces = |other: &&usize| cells[**other].settings.decomposition == own.settings.decomposition;
        serial.iter().find(is_on_its_pieces).or(serial.first()).copied()
    };
    cells.iter().map(serial_of).collect()
}

/// The image of a row in one word: the planned one, or with a time limit that of the samples that were reached.
fn image_of(record: &Record, planned: &str) -> String {
    if record.time_limit_s.is_some() { record.image_key().to_string() } else { planned.to_string() }
}

/// Marks a row as failed if its checksum differs from that of earlier rows of its image: a schedule must not change a
/// bit.
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
