//! `run EXPERIMENT --set AXIS=VALUES`: the same experiment with other values.
//!
//! ```text
//! pathmark run thread-scaling --set scene=my/room.toml --set threads=1,2,4,8
//! ```
//!
//! The result is the text of a complete definition. It is kept beside the rows and can be run again without the
//! options.

use super::definition::REFERENCE_SPP;
use super::{Definition, Profile};
use crate::error::{InputError, Result};
use crate::input::parse;
use crate::measure::{Kind, SETTINGS, Setting, parse_size};
use std::collections::BTreeSet;
use std::path::Path;
use toml::{Table, Value};

/// The tables of profiles, which may hold a value instead of the matrix.
const PROFILES: [&str; 3] = ["quick", "full", "reports"];

impl Definition {
    /// The definition with other values of some axes: `AXIS=VALUE,VALUE...` in every matrix and profile.
    pub fn with_values(self, pairs: &[String]) -> Result<Self> {
        if pairs.is_empty() {
            return Ok(self);
        }
        let mut table: Table = parse(&self.text, &self.file)?;
        for pair in pairs {
            set(&mut table, pair)?;
            self.check_scenes(pair)?;
        }
        let given: Vec<String> = pairs.iter().map(|pair| format!("--set {pair}")).collect();
        let text = toml::to_string_pretty(&table)
            .map_err(|e| InputError::new("set", given.join(" "), format!("cannot be written as TOML: {e}")))?;
        let text = format!("# {} with {}\n{text}", self.file, given.join(" "));
        let mut changed = Self::from_text(&self.lab, &self.name, &self.file, &text)?;
        (changed.asked, changed.set) = (self.asked, [self.set, pairs.to_vec()].concat());
        Ok(changed)
    }

    /// Refuses a scene's file that is both in the current folder, where a user looks first, and beside the definition,
    /// where the scenes of a definition are.
    fn check_scenes(&self, pair: &str) -> Result<()> {
        let Some(("scene", scenes)) = pair.split_once('=') else { return Ok(()) };
        let folder = Path::new(&self.file).parent().unwrap_or(Path::new(""));
        for scene in scenes.split(',') {
            let found = [Path::new(scene).canonicalize(), folder.join(scene).canonicalize()];
            if matches!(&found, [Ok(here), Ok(beside)] if here.is_file() && here != beside) {
                let problem = "is one file here and another one beside the experiment";
                return Err(InputError::new("scene", scene, problem)
                    .allowed("a path from the root, or one that leads to one file only")
                    .into());
            }
        }
        Ok(())
    }
}

impl Definition {
    /// The sizes of matrices with one of their own, if values were set and no size is among them: the user may expect that of
    /// the profile.
    pub fn kept_sizes(&self, profile: Profile) -> BTreeSet<&str> {
        if self.set.is_empty() || self.set.iter().any(|pair| pair.starts_with("size=")) {
            return BTreeSet::new();
        }
        self.matrices(profile).filter_map(|matrix| matrix.values("size")).flatten().map(String::as_str).collect()
    }
}

fn set(table: &mut Table, pair: &str) -> Result<()> {
    let names: Vec<&str> = SETTINGS.iter().map(|axis| axis.name).chain([REFERENCE_SPP]).collect();
    let Some((name, values)) = pair.split_once('=') else {
        let problem = "lacks the = between axis and values";
        return Err(InputError::new("set", pair, problem).allowed("AXIS=VALUE,VALUE...").into());
    };
    if values.split(',').any(|value| value.trim().is_empty()) {
        return Err(InputError::new("set", pair, "has an empty value").allowed("AXIS=VALUE,VALUE...").into());
    }
    if name == REFERENCE_SPP {
        let spp = number(name, values)?;
        profiles(table).for_each(|profile| _ = profile.insert(name.to_string(), spp.clone()));
        return Ok(());
    }
    let Some(axis) = Setting::named(name) else {
        return Err(InputError::new("set", name, "there is no axis of that name").allowed(names.join(", ")).into());
    };
    let value = value_of(axis, values)?;
    for profile in profiles(table) {
        // A profile always has a size, and the matrix's own comes before it.
        if name != "size" {
            profile.remove(name);
        }
    }
    for matrix in matrices(table) {
        matrix.insert(name.to_string(), value.clone());
    }
    Ok(())
}

fn profiles(table: &mut Table) -> impl Iterator<Item = &mut Table> {
    let profiles = table.iter_mut().filter(|(name, _)| PROFILES.contains(&name.as_str()));
    profiles.filter_map(|(_, value)| value.as_table_mut())
}

fn matrices(table: &mut Table) -> Vec<&mut Table> {
    match table.get_mut("matrix") {
        Some(Value::Table(matrix)) => vec![matrix],
        Some(Value::Array(matrices)) => matrices.iter_mut().filter_map(Value::as_table_mut).collect(),
        _ => Vec::new(),
    }
}

/// The value in a definition: one size, or a list of words, numbers or switches.
fn value_of(axis: &Setting, values: &str) -> Result<Value> {
    let each = values.split(',').map(str::trim);
    let switch = |value: &str| -> Result<Value> {
        let parsed = value.parse().map(Value::Boolean);
        parsed.map_err(|_| InputError::new(axis.name, value, "is not true or false").into())
    };
    let seconds = |value: &str| -> Result<Value> {
        let parsed = value.parse().map(Value::Float);
        parsed.map_err(|_| InputError::new(axis.name, value, "is not a number").into())
    };
    Ok(match axis.kind {
        Kind::Size => {
            let (width, height) = parse_size(values)?;
            Value::Array(vec![Value::Integer(width.into()), Value::Integer(height.into())])
        }
        Kind::Switch => Value::Array(each.map(switch).collect::<Result<_>>()?),
        Kind::Seconds => Value::Array(each.map(seconds).collect::<Result<_>>()?),
        Kind::Name | Kind::Auto => Value::Array(each.map(Value::from).collect()),
        Kind::Workers => {
            let workers = |value: &str| if value == "all" { Ok(value.into()) } else { number(axis.name, value) };
            Value::Array(each.map(workers).collect::<Result<_>>()?)
        }
        Kind::Count | Kind::Samples | Kind::Seed => {
            Value::Array(each.map(|value| number(axis.name, value)).collect::<Result<_>>()?)
        }
    })
}

fn number(name: &str, value: &str) -> Result<Value> {
    let parsed = value.parse().map(Value::Integer);
    parsed.map_err(|_| InputError::new(name, value, "is not a whole number").into())
}
