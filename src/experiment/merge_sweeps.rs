//! Merging of parts of sweeps: `pathmark merge DIR...` after `pathmark run EXPERIMENT --shard 1/4 --out DIR` on several
//! machines.
//!
//! A ratio of two times compares two rows of one repetition, so a repetition must not mix machines: repetition r of
//! part i of n becomes repetition r · n + i - 1. Rows of unlike machines are kept in separate folders.

use super::cell::trace_file;
use super::records_file::read_records;
use super::run_file::{MACHINE, RunFile, read_run_file};
use super::sweep_shard::SweepShard;
use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::measure::Record;
use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The largest number of missing parts that are named.
const MOST_TOLD: usize = 20;

/// A part of one sweep.
struct Part {
    folder: PathBuf,
    shard: SweepShard,
    run: RunFile,
}

/// A merged sweep.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MergedSweep {
    /// The folder from which a report is made.
    pub out: PathBuf,
    /// The experiment.
    pub name: String,
    /// Number of its rows.
    pub rows: usize,
    /// Missing parts, such as `2/4`.
    pub missing: Vec<String>,
}

fn refused(field: &str, path: &Path, problem: impl Into<String>) -> InputError {
    InputError::new(field, path.display().to_string(), problem)
}

/// The parts in a folder that `run --out` made, each with its experiment's name.
fn parts_in(folder: &Path) -> Result<Vec<(String, Part)>> {
    let entries = fs::read_dir(folder).map_err(|e| match e.kind() {
        ErrorKind::NotFound => refused("part", folder, "there is no such folder").into(),
        _ => Error::system("reading", folder, e),
    })?;
    let mut parts = Vec::new();
    for entry in entries {
        let path = entry.map_err(|e| Error::system("reading", folder, e))?.path();
        if !path.join(MACHINE).is_file() || !path.join("records.csv").is_file() {
            continue;
        }
        let run = read_run_file(&path.join(MACHINE))?;
        let Some(text) = &run.shard else { continue };
        let shard = SweepShard::parse(text)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        parts.push((name, Part { folder: path, shard, run }));
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
            let problem = format!("these parts of {name} are missing: {}", missing.join(", "));
            let allowed = "all parts, or --partial for the available rows";
            return Err(refused("part", &parts[0].folder, problem).allowed(allowed).into());
        }
        checked.push((name, parts, missing));
    }
    let mut merged = Vec::new();
    for (name, parts, missing) in checked {
        let machines = by_machine(parts);
        let is_one = machines.len() == 1;
        for (index, parts) in machines.iter().enumerate() {
            let out = if is_one { out.to_path_buf() } else { out.join(format!("machine-{}", index + 1)) };
            let rows = write(parts, &out, &name, command)?;
            merged.push(MergedSweep { out, name: name.clone(), rows, missing: missing.clone() });
        }
    }
    Ok(merged)
}

/// Refuses parts that do not belong together; returns the missing ones.
fn check(parts: &[Part]) -> Result<Vec<String>> {
    let first = &parts[0];
    for part in &parts[1..] {
        let facts = |part: &Part| {
            let RunFile { profile, definition_hash, machine, .. } = &part.run;
            let mut facts = vec![("parts", part.shard.count.to_string()), ("profile", profile.clone())];
            facts.push(("definition", definition_hash.clone()));
            facts.push(("cache", part.run.cached.to_string()));
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
    let is_there = |index: u32| parts.iter().any(|part| part.shard.index == index);
    let count = first.shard.count;
    let missing = (1..=count).filter(|index| !is_there(*index)).take(MOST_TOLD);
    Ok(missing.map(|index| format!("{index}/{count}")).collect())
}

/// Groups the parts by machine: by model and number of processors.
fn by_machine(parts: Vec<Part>) -> Vec<Vec<Part>> {
    let mut machines: Vec<Vec<Part>> = Vec::new();
    for part in parts {
        let alike = machines.iter_mut().find(|parts| parts[0].run.machine.identity() == part.run.machine.identity());
        match alike {
            Some(parts) => parts.push(part),
            None => machines.push(vec![part]),
        }
    }
    machines
}

/// Writes the folder of one sweep; returns its number of rows.
fn write(parts: &[Part], out: &Path, name: &str, command: &str) -> Result<usize> {
    let folder = out.join(name);
    if folder.exists() {
        return Err(refused("output", &folder, "already exists").allowed("another folder").into());
    }
    let make = |path: &Path| fs::create_dir_all(path).map_err(|e| Error::system("creating", path, e));
    make(&folder)?;
    let mut rows = Vec::new();
    for Part { folder: from, shard, .. } in parts {
        for row in read_records(&from.join("records.csv"))? {
            let repetition = shard.repetition(row.repetition);
            let trace = |repetition| Path::new("traces").join(trace_file(&row.cell, repetition));
            if from.join(trace(row.repetition)).is_file() {
                make(&folder.join("traces"))?;
                copy(&from.join(trace(row.repetition)), &folder.join(trace(repetition)))?;
            }
            let order = row.order * u64::from(shard.count) + u64::from(shard.index - 1);
            rows.push(Record { repetition, order, ..row });
        }
        copy_all(&from.join("images"), &folder.join("images"))?;
        if let Some(references) = from.parent().map(|parent| parent.join("references")) {
            copy_all(&references, &out.join("references"))?;
        }
    }
    rows.sort_by_key(|row| row.order);
    let mut writer = csv::Writer::from_writer(Vec::new());
    let path = folder.join("records.csv");
    for row in &rows {
        writer.serialize(row).map_err(|e| Error::system("writing", &path, e.into()))?;
    }
    let bytes = writer.into_inner().map_err(|e| Error::system("writing", &path, e.into_error()))?;
    atomic_file::write(&path, |file| file.write_all(&bytes))?;
    let first = &parts[0];
    for file in ["experiment.toml", "calibration.csv"] {
        if first.folder.join(file).is_file() {
            copy(&first.folder.join(file), &folder.join(file))?;
        }
    }
    RunFile { command: command.to_string(), shard: None, ..first.run.clone() }.write(&folder.join(MACHINE))?;
    Ok(rows.len())
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
