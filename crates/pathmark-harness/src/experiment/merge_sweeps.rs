//! Merging of parts of sweeps: `pathmark merge DIR...` after `pathmark run EXPERIMENT --shard 1/4 --out DIR` on several
//! machines.
//!
//! A ratio of two times compares two rows of one repetition, so a repetition must not mix machines: repetition r of
//! part i of n becomes repetition r · n + i - 1. Rows of unlike machines are kept in separate folders.
//!
//! All parts are read and checked before any folder is made, and a merge that fails removes what it made.

use super::cell::trace_file;
use super::packed_rows::{has_records, records_path};
use super::records_file::{RECORDS, read_records};
use super::run_file::{MACHINE, RunFile, read_run_file};
use super::sweep_shard::SweepShard;
use crate::atomic_file;
use crate::csv_file;
use crate::digest;
use crate::error::{Error, InputError, Result};
use crate::files::entries;
use crate::measure::{Record, joined_calibrations, read_calibration};
use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

const MOST_TOLD: usize = 20;

struct Part {
    folder: PathBuf,
    shard: SweepShard,
    run: RunFile,
    rows: Vec<Record>,
}

impl Part {
    /// The rows that it still lacks, in words; `None` if it is finished.
    fn lack(&self) -> Option<String> {
        let (have, want) = (self.rows.len() as u64, self.run.rows.unwrap_or(1));
        (want > have).then(|| format!("{}: {have} of at least {want} rows in {}", self.shard, self.folder.display()))
    }

    /// Its rows, numbered as rows of the merged sweep.
    fn numbered(&self) -> Result<Vec<Record>> {
        let number = |row: &Record| {
            let too_large = |field: &str, value: String| {
                let file = records_path(&self.folder).display().to_string();
                InputError::new(field, value, format!("is too large for a sweep of {} parts", self.shard.count))
                    .in_file(file, None)
            };
            let repetition = self.shard.repetition(row.repetition);
            let repetition = repetition.ok_or_else(|| too_large("repetition", row.repetition.to_string()))?;
            let order = row.run_order.checked_mul(u64::from(self.shard.count));
            let order = order.and_then(|order| order.checked_add(u64::from(self.shard.index - 1)));
            let order = order.ok_or_else(|| too_large("run_order", row.run_order.to_string()))?;
            Ok(Record { repetition, run_order: order, ..row.clone() })
        };
        self.rows.iter().map(number).collect()
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MergedSweep {
    /// The folder from which a report is made.
    pub out: PathBuf,
    pub name: String,
    pub rows: usize,
    /// Parts that are missing, such as `2/4`, or not finished.
    pub missing: Vec<String>,
}

fn refused(field: &str, path: &Path, problem: impl Into<String>) -> InputError {
    InputError::new(field, path.display().to_string(), problem)
}

/// The parts in a folder that `run --out` made, each with its experiment's name.
fn parts_in(folder: &Path) -> Result<Vec<(String, Part)>> {
    let found = entries(folder).map_err(|error| match &error {
        Error::System { source, .. } if source.kind() == ErrorKind::NotFound => {
            refused("part", folder, "there is no such folder").into()
        }
        _ => error,
    })?;
    let mut parts = Vec::new();
    for path in found {
        if !path.join(MACHINE).is_file() || !has_records(&path) {
            continue;
        }
        let run = read_run_file(&path.join(MACHINE))?;
        let Some(text) = &run.shard else { continue };
        let shard = SweepShard::parse(text)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let rows = read_records(&records_path(&path))?;
        parts.push((name, Part { folder: path, shard, run, rows }));
    }
    if parts.is_empty() {
        let allowed = "folders that `pathmark run EXPERIMENT --shard I/N --out DIR` made";
        return Err(refused("part", folder, "contains no part of a sweep").allowed(allowed).into());
    }
    Ok(parts)
}

/// Merges the parts of each experiment below `out`. `command` is recorded as the command that made the rows.
pub fn merge_sweeps(folders: &[PathBuf], out: &Path, partial: bool, command: &str) -> Result<Vec<MergedSweep>> {
    let mut sweeps: BTreeMap<String, Vec<Part>> = BTreeMap::new();
    for folder in folders {
        for (name, part) in parts_in(folder)? {
            sweeps.entry(name).or_default().push(part);
        }
    }
    let mut checked = Vec::new();
    for (name, mut parts) in sweeps {
        parts.sort_by_key(|part| part.shard.index);
        let missing = check(&parts)?;
        if !missing.is_empty() && !partial {
            let problem = format!("these parts of {name} are missing or not finished: {}", missing.join(", "));
            let allowed = "all parts, or --partial for the available rows";
            return Err(refused("part", &parts[0].folder, problem).allowed(allowed).into());
        }
        checked.push((name, parts, missing));
    }
    let mut plans = Vec::new();
    for (name, parts, missing) in checked {
        let machines = by_machine(parts);
        let is_one = machines.len() == 1;
        for (index, parts) in machines.into_iter().enumerate() {
            let out = if is_one { out.to_path_buf() } else { out.join(format!("machine-{}", index + 1)) };
            let folder = out.join(&name);
            if folder.exists() {
                return Err(refused("output", &folder, "already exists").allowed("another folder").into());
            }
            let mut rows = Vec::new();
            for part in &parts {
                rows.extend(part.numbered()?);
            }
            rows.sort_by_key(|row| row.run_order);
            let sweep = MergedSweep { out, name: name.clone(), rows: rows.len(), missing: missing.clone() };
            plans.push((sweep, parts, rows));
        }
    }
    let mut merged = Vec::new();
    for (sweep, parts, rows) in plans {
        let written = write(&parts, &rows, &sweep, command);
        merged.push(sweep);
        if let Err(error) = written {
            merged.iter().for_each(MergedSweep::remove);
            return Err(error);
        }
    }
    Ok(merged)
}

impl MergedSweep {
    pub fn folder(&self) -> PathBuf {
        self.out.join(&self.name)
    }

    /// Removes its folder, so that another attempt can make it. The parts still have the rows.
    pub fn remove(&self) {
        fs::remove_dir_all(self.folder()).ok();
    }
}

/// Refuses parts that do not belong together; returns the missing ones.
fn check(parts: &[Part]) -> Result<Vec<String>> {
    let first = &parts[0];
    for part in &parts[1..] {
        let facts = |part: &Part| {
            let RunFile { profile, definition_hash, machine, .. } = &part.run;
            let mut facts = vec![("parts", part.shard.count.to_string()), ("profile", profile.clone())];
            facts.push(("definition", definition_hash.clone()));
            facts.extend(machine.build());
            facts
        };
        let differs = facts(part).into_iter().zip(facts(first)).find(|(found, expected)| found.1 != expected.1);
        if let Some(((name, found), (_, expected))) = differs {
            let problem = format!("does not belong to {}: {name} is {found}, not {expected}", first.folder.display());
            return Err(refused("part", &part.folder, problem).allowed("parts of one sweep").into());
        }
    }
    if let Some(pair) = parts.windows(2).find(|pair| pair[0].shard == pair[1].shard) {
        let problem = format!("is part {}, the same as {}", pair[1].shard, pair[0].folder.display());
        return Err(refused("part", &pair[1].folder, problem).allowed("each part once").into());
    }
    if parts.iter().all(|part| part.rows.is_empty()) {
        return Err(refused("part", &first.folder, "has no rows, and neither has another part").into());
    }
    let count = first.shard.count;
    let mut found = parts.iter().peekable();
    let missing = (1..=count).filter_map(|index| match found.next_if(|part| part.shard.index == index) {
        Some(part) => part.lack(),
        None => Some(format!("{index}/{count}")),
    });
    Ok(missing.take(MOST_TOLD).collect())
}

fn run_of(parts: &[Part], command: &str) -> RunFile {
    // Intervals that hold at every look are valid for any part, the usual ones only where no part had a goal.
    let mut goals: Vec<&str> = parts.iter().filter_map(|part| part.run.until.as_deref()).collect();
    goals.sort_unstable();
    goals.dedup();
    let sweeps: Option<Vec<&str>> = parts.iter().map(|part| part.run.sweep.as_deref()).collect();
    let first = &parts[0].run;
    RunFile {
        command: command.to_string(),
        shard: None,
        rows: None,
        until: Some(goals.join(", ")).filter(|goals| !goals.is_empty()),
        // The limits of matrices applied if they did in any part.
        uncapped: parts.iter().all(|part| part.run.uncapped),
        baseline: first.baseline.clone().filter(|_| parts.iter().all(|part| part.run.baseline.is_some())),
        // Both builds' rows get the same number, because both were measured by the same parts.
        sweep: sweeps.map(|sweeps| digest::of_text(&sweeps.join(" "))),
        ..first.clone()
    }
}

fn by_machine(parts: Vec<Part>) -> Vec<Vec<Part>> {
    let mut machines: Vec<Vec<Part>> = Vec::new();
    for part in parts {
        let alike = machines.iter_mut().find(|parts| parts[0].run.machine.difference(&part.run.machine).is_none());
        match alike {
            Some(parts) => parts.push(part),
            None => machines.push(vec![part]),
        }
    }
    machines
}

fn write(parts: &[Part], rows: &[Record], sweep: &MergedSweep, command: &str) -> Result<()> {
    let folder = sweep.folder();
    let make = |path: &Path| fs::create_dir_all(path).map_err(|e| Error::system("creating", path, e));
    make(&folder)?;
    for part in parts {
        let from = &part.folder;
        for (own, merged) in part.rows.iter().zip(part.numbered()?) {
            let trace = |row: &Record| Path::new("traces").join(trace_file(&row.cell, row.repetition));
            if from.join(trace(own)).is_file() {
                make(&folder.join("traces"))?;
                copy(&from.join(trace(own)), &folder.join(trace(&merged)))?;
            }
        }
        copy_all(&from.join("images"), &folder.join("images"))?;
        if let Some(references) = from.parent().map(|parent| parent.join("references")) {
            copy_all(&references, &sweep.out.join("references"))?;
        }
    }
    csv_file::write(&folder.join(RECORDS), rows)?;
    let definition = parts[0].folder.join("experiment.toml");
    if definition.is_file() {
        copy(&definition, &folder.join("experiment.toml"))?;
    }
    let calibrations = parts.iter().map(|part| part.folder.join("calibration.csv")).filter(|path| path.is_file());
    let calibrations = calibrations.map(|path| read_calibration(&path)).collect::<Result<Vec<_>>>()?;
    if !calibrations.is_empty() {
        csv_file::write(&folder.join("calibration.csv"), joined_calibrations(calibrations))?;
    }
    run_of(parts, command).write(&folder.join(MACHINE))
}

/// Copies the files of `from`, if it exists, except those that `to` already has.
fn copy_all(from: &Path, to: &Path) -> Result<()> {
    let Ok(entries) = fs::read_dir(from) else { return Ok(()) };
    fs::create_dir_all(to).map_err(|e| Error::system("creating", to, e))?;
    for entry in entries {
        let path = entry.map_err(|e| Error::system("reading", from, e))?.path();
        let Some(name) = path.file_name() else { continue };
        if path.is_file() && !to.join(name).exists() {
            copy(&path, &to.join(name))?;
        }
    }
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    let bytes = fs::read(from).map_err(|e| Error::system("reading", from, e))?;
    atomic_file::write(to, |file| file.write_all(&bytes))
}
