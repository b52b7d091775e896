//! `machine.toml`: the machine on which the rows beside it were measured, and the command.

use super::{Cell, Profile, Sweep};
use crate::analysis::confidence_sequence::Stopping;
use crate::atomic_file;
use crate::digest;
use crate::error::{InputError, Result};
use crate::input::{parse, read_text};
use crate::measure::{Machine, utc_now};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::process;
use std::time::SystemTime;

pub const MACHINE: &str = "machine.toml";

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RunFile {
    pub command: String,
    /// Name and version of the program; the commit of Pathmark's own sources is the machine's. Empty in old files.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub program: String,
    /// The name or path by which the command loaded the experiment; empty in old files.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub experiment: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    /// `quick`, `full` or `reports`.
    pub profile: String,
    /// The part of the sweep that these rows are, such as `2/4`; `None` if they are all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<String>,
    /// The other program whose rows were measured in turns with these; `None` without one.
    #[serde(default, alias = "against", skip_serializing_if = "Option::is_none")]
    pub baseline: Option<String>,
    /// The number of the sweep that measured these rows in turns with the other program's; rows of one number are pairs.
    /// `None` without another program, and in older files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<String>,
    /// The time at which the file was written, before the first row; empty in older files.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub started_utc: String,
    /// The fewest rows of the finished sweep; `None` in older files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rows: Option<u64>,
    /// The goal of the repetitions: a share, `fastest` or `order`; `None` if their number was fixed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<String>,
    /// Whether the command set the repetitions, so that the limits of matrices did not apply.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub uncapped: bool,
    /// The devices that the kernels of this sweep may use, each with the driver's name: `cuda:0: NVIDIA H100`. Empty
    /// without such a kernel, and in older files.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub devices: Vec<String>,
    /// SHA-256 of the definition's text, shortened to 16 hexadecimal digits.
    pub definition_hash: String,
    pub machine: Machine,
}

/// A number that no other sweep has: of this process at this time.
fn sweep_number() -> String {
    digest::of_text(&format!("{:?} {}", SystemTime::now(), process::id()))
}

pub fn read_run_file(path: &Path) -> Result<RunFile> {
    parse(&read_text(path)?, &path.display().to_string())
}

impl RunFile {
    /// The description of a measurement without a definition, on this machine.
    pub fn of_now(command: String) -> Self {
        let profile = Profile::Quick.name().to_string();
        Self { command, profile, started_utc: utc_now(), machine: Machine::look(), ..Self::default() }
    }

    pub fn write(&self, path: &Path) -> Result<()> {
        let text = toml::to_string_pretty(self)
            .map_err(|e| InputError::new("machine", "", format!("cannot be written as TOML: {e}")))?;
        atomic_file::write(path, |out| out.write_all(text.as_bytes()))
    }

    /// How the number of repetitions was chosen.
    pub(super) fn stopping(&self) -> Stopping {
        if self.until.is_some() { Stopping::Sequential } else { Stopping::Fixed }
    }

    /// Refuses to mix rows that are not repetitions of each other: another processor, revision, profile or definition.
    pub(super) fn check_same(&self, now: &Self, path: &Path) -> Result<()> {
        if self.definition_hash != now.definition_hash {
            let problem = "is not the one that these rows were measured with";
            return Err(InputError::new("experiment", "", problem)
                .allowed("another --out, or the old file and options; experiment.toml beside the rows has the old text")
                .in_file(path.display().to_string(), None)
                .into());
        }
        let part = |run: &Self| run.shard.clone().unwrap_or_else(|| "none".to_string());
        let until = |run: &Self, other: &Self| match (&run.until, &other.until) {
            (Some(own), None) => own.clone(),
            (Some(_), Some(_)) => "some goal".to_string(),
            (None, _) => "none".to_string(),
        };
        // Rows of an older version do not tell their program.
        let program = if self.program.is_empty() { &now.program } else { &self.program };
        let mut pairs = vec![
            ("profile", self.profile.clone(), now.profile.clone()),
            ("shard", part(self), part(now)),
            ("until", until(self, now), until(now, self)),
            ("program", program.clone(), now.program.clone()),
        ];
        pairs.extend(self.machine.difference(&now.machine));
        match pairs.into_iter().find(|(_, old, new)| old != new) {
            None => Ok(()),
            Some((name, old, new)) => {
                Err(InputError::new(name, old, format!("is the value of the existing rows, but it is now {new}"))
                    .allowed("the same value, or another --out")
                    .in_file(path.display().to_string(), None)
                    .into())
            }
        }
    }
}

/// The devices that the cells' kernels name, and accelerators for kernels that name none.
#[cfg(feature = "device")]
fn devices(cells: &[Cell]) -> Vec<String> {
    let kernels: Vec<&str> = cells.iter().map(|cell| cell.settings.spec.kernel.as_str()).collect();
    if !kernels.iter().any(|kernel| kernel.contains(crate::kernel::DEVICE_NAME)) {
        return Vec::new();
    }
    let is_meant = |id: &str| kernels.iter().any(|kernel| kernel.contains(id));
    let found = crate::kernel::devices().into_iter().filter(|device| device.is_there);
    let used = found.filter(|device| device.is_accelerator || is_meant(&device.id));
    used.map(|device| format!("{}: {}", device.id, device.about)).collect()
}

#[cfg(not(feature = "device"))]
fn devices(_: &[Cell]) -> Vec<String> {
    Vec::new()
}

impl Sweep<'_> {
    pub(super) fn run_file(&self) -> Result<RunFile> {
        let Self { definition, options, cells, until, .. } = self;
        let repetitions = if until.is_some() { 1 } else { self.repetitions()? };
        let rows = |cell: &Cell| cell.points.len() as u64 * u64::from(cell.repetitions(repetitions));
        Ok(RunFile {
            program: definition.lab.program().join(" "),
            experiment: definition.asked.clone(),
            set: definition.set.clone(),
            profile: options.profile.name().to_string(),
            shard: options.shard.map(|shard| shard.to_string()),
            baseline: options.baseline.as_ref().map(|program| program.display().to_string()),
            sweep: options.baseline.as_ref().map(|_| sweep_number()),
            rows: Some(cells.iter().map(rows).sum()),
            until: until.as_ref().map(|until| until.text.clone()),
            uncapped: options.say_how_often(),
            devices: devices(cells),
            definition_hash: digest::of_text(&definition.text),
            ..RunFile::of_now(options.command.clone())
        })
    }
}
