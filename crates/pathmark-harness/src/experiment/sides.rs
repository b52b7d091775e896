//! The two measurements of a comparison: their experiments, rows, and the cells that the new one lost.

use super::instructions;
use super::packed_rows::{has_records, records_path};
use super::records_file::read_records;
use super::run_file::{MACHINE, RunFile, read_run_file};
use crate::error::{Error, InputError, Result};
use crate::files::entries;
use crate::measure::Record;
use serde::Serialize;
use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

pub(super) struct Side {
    /// The folder of the experiment, or the file of rows.
    path: PathBuf,
    pub(super) run: Option<RunFile>,
    pub(super) rows: Vec<Record>,
    pub(super) instructions: BTreeMap<String, u64>,
}

#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Compared<T> {
    /// Name and comparison of each experiment that both have. The name is empty if two experiments were given, and not
    /// two folders of experiments.
    pub experiments: Vec<(String, T)>,
    /// The experiments that only the old and that only the new measurement has.
    pub alone: [Vec<String>; 2],
}

impl<T> Compared<T> {
    pub(super) fn map<U>(self, compare: impl FnMut((String, T)) -> Result<(String, U)>) -> Result<Compared<U>> {
        let experiments = self.experiments.into_iter().map(compare).collect::<Result<_>>()?;
        Ok(Compared { experiments, alone: self.alone })
    }
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FailedCell {
    pub cell: String,
    pub failed: usize,
    pub rows: usize,
    pub error: String,
}

/// The cells that the old measurement has and the new one lost.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Lost {
    pub missing: Vec<String>,
    pub failed: Vec<FailedCell>,
}

#[derive(Default)]
struct Outcomes<'a> {
    sound: usize,
    failed: usize,
    error: &'a str,
    rows: usize,
}

fn outcomes(rows: &[Record], is_sound: impl Fn(&Record) -> bool) -> BTreeMap<&str, Outcomes<'_>> {
    let mut cells: BTreeMap<&str, Outcomes<'_>> = BTreeMap::new();
    for row in rows {
        let own = cells.entry(&row.cell).or_default();
        own.rows += 1;
        if row.error.is_empty() {
            own.sound += usize::from(is_sound(row));
        } else {
            own.error = if own.failed == 0 { &row.error } else { own.error };
            own.failed += 1;
        }
    }
    cells
}

impl Lost {
    /// Finds the cells that have sound rows in the old measurement, and only failed rows or none in the new one. A cell
    /// is also lost if it failed in some repetitions of the new measurement and in none of the old one. `is_sound`
    /// tells whether a row that did not fail has anything to compare.
    pub(super) fn of([old, new]: &[Side; 2], is_sound: impl Fn(&Record) -> bool) -> Self {
        let (before, after) = (outcomes(&old.rows, &is_sound), outcomes(&new.rows, &is_sound));
        let mut lost = Self::default();
        for (cell, own) in before.iter().filter(|(_, own)| own.sound > 0) {
            match after.get(cell) {
                Some(now) if now.failed > 0 && (own.failed == 0 || now.sound == 0) => {
                    let Outcomes { failed, rows, error, .. } = *now;
                    lost.failed.push(FailedCell { cell: (*cell).to_string(), failed, rows, error: error.to_string() });
                }
                Some(now) if now.sound > 0 => {}
                _ => lost.missing.push((*cell).to_string()),
            }
        }
        lost
    }
}

impl Side {
    fn read(path: &Path) -> Result<Self> {
        let (file, folder) =
            if path.is_dir() { (records_path(path), Some(path)) } else { (path.to_path_buf(), path.parent()) };
        let machine = folder.map(|folder| folder.join(MACHINE)).filter(|path| path.is_file());
        let run = machine.map(|path| read_run_file(&path)).transpose()?;
        let (rows, instructions) = (read_records(&file)?, instructions::read(&file)?);
        Ok(Self { path: path.to_path_buf(), run, rows, instructions })
    }

    /// Whether its rows and the other's were measured in turns, by one sweep.
    pub(super) fn is_in_turns_with(&self, other: &Self) -> bool {
        let [Some(own), Some(others)] = [&self.run, &other.run] else { return false };
        if own.baseline.is_none() || others.baseline.is_none() {
            return false;
        }
        match (&own.sweep, &others.sweep) {
            // Older sweeps have no number, but one of them left both folders if one lies below the other.
            (None, None) => [(self, other), (other, self)].into_iter().any(|(new, old)| new.has_baseline(old)),
            (own, others) => own == others,
        }
    }

    /// Whether the other folder is where an old sweep into this folder left the rows of its other build.
    fn has_baseline(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|side| fs::canonicalize(&side.path).ok());
        let below = own.as_deref().and_then(|own| Some(own.parent()?.join("against").join(own.file_name()?)));
        below.is_some() && below == others
    }
}

fn refused(field: &str, path: &Path, problem: &str) -> InputError {
    InputError::new(field, path.display().to_string(), problem)
}

/// The experiments below a folder, by name; `None` for the folder of one experiment and for a file.
fn experiments_in(field: &str, path: &Path) -> Result<Option<BTreeMap<String, PathBuf>>> {
    if !path.is_dir() || has_records(path) {
        return Ok(None);
    }
    let mut found = BTreeMap::new();
    for folder in entries(path)? {
        if let Some(name) = folder.file_name().filter(|_| has_records(&folder)) {
            found.insert(name.to_string_lossy().into_owned(), folder);
        }
    }
    if found.is_empty() {
        let allowed = "the folder of an experiment, a folder of experiments, or a file of rows";
        return Err(refused(field, path, "contains neither records.csv nor an experiment").allowed(allowed).into());
    }
    Ok(Some(found))
}

fn paths(old: &Path, new: &Path) -> Result<Compared<[PathBuf; 2]>> {
    for (field, path) in [("old", old), ("new", new)] {
        match fs::metadata(path) {
            Err(e) if e.kind() == ErrorKind::NotFound => {
                return Err(refused(field, path, "there is no such file").into());
            }
            other => other.map_err(|e| Error::system("reading", path, e))?,
        };
    }
    let (before, after) = match (experiments_in("old", old)?, experiments_in("new", new)?) {
        (None, None) => {
            let experiments = vec![(String::new(), [old.to_path_buf(), new.to_path_buf()])];
            return Ok(Compared { experiments, alone: Default::default() });
        }
        (Some(before), Some(after)) => (before, after),
        (before, _) => {
            let (one, [field, other], path) =
                if before.is_none() { (old, ["new", "old"], new) } else { (new, ["old", "new"], old) };
            let problem = format!(
                "contains several experiments and no records.csv, but the {other} measurement is {}",
                one.display()
            );
            return Err(refused(field, path, &problem)
                .allowed("two experiments, or two folders of experiments")
                .into());
        }
    };
    let alone = |own: &BTreeMap<String, PathBuf>, other: &BTreeMap<String, PathBuf>| {
        own.keys().filter(|name| !other.contains_key(*name)).cloned().collect::<Vec<_>>()
    };
    let alone = [alone(&before, &after), alone(&after, &before)];
    let both = before.into_iter().filter_map(|(name, old)| Some((name.clone(), [old, after.get(&name)?.clone()])));
    let experiments: Vec<_> = both.collect();
    if experiments.is_empty() {
        let problem = format!("has no experiment in common with {}", old.display());
        return Err(refused("new", new, &problem).allowed("folders with experiments of the same names").into());
    }
    Ok(Compared { experiments, alone })
}

/// Reads both measurements. Refuses those of two machines unless `across_machines`, and those without a cell in common.
pub(super) fn sides(old: &Path, new: &Path, across_machines: bool) -> Result<Compared<[Side; 2]>> {
    paths(old, new)?.map(|(name, [old, new])| {
        let both = [Side::read(&old)?, Side::read(&new)?];
        if let [Some(before), Some(after)] = [&both[0].run, &both[1].run]
            && !across_machines
            && let Some((fact, then, now)) = before.machine.hardware_difference(&after.machine)
        {
            let problem = format!("was measured on another machine: {fact} is {now}, not {then}");
            return Err(refused("new", &new, &problem).allowed("--across-machines").into());
        }
        let cells: HashSet<&str> = both[0].rows.iter().map(|row| row.cell.as_str()).collect();
        if !both[1].rows.iter().any(|row| cells.contains(row.cell.as_str())) {
            let problem = format!("has no cell in common with {}", old.display());
            let allowed = "measurements of the same experiment at the same size";
            return Err(refused("new", &new, &problem).allowed(allowed).into());
        }
        Ok((name, both))
    })
}

/// Refuses cells whose images have other bits in both measurements: more time for another image does not mean slower.
pub(super) fn check_images([before, after]: &[Side; 2]) -> Result<()> {
    // A row whose checksum differs from those of its own sweep has failed, and its cell is lost.
    let has_image = |row: &&Record| !row.checksum.is_empty() && row.error.is_empty();
    let old: BTreeMap<&str, &str> =
        before.rows.iter().filter(has_image).map(|row| (row.cell.as_str(), row.checksum.as_str())).collect();
    let is_other = |row: &&Record| old.get(row.cell.as_str()).is_some_and(|checksum| *checksum != row.checksum);
    let Some(row) = after.rows.iter().filter(has_image).find(is_other) else { return Ok(()) };
    let problem =
        format!("has another image than the old measurement in {}: the builds have different revisions", row.cell);
    let allowed = "builds whose images have the same bits, or --across-revisions";
    Err(refused("new", &after.path, &problem).allowed(allowed).into())
}
