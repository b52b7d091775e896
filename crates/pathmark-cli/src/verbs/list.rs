//! `pathmark list [KIND [NAME]]`: all names that a user can choose from, or one of them.

use crate::console::output::{counted, print, print_json};
use crate::error::{InputError, Result};
use crate::experiment::{Definition, keys};
use crate::film::DECOMPOSITIONS;
use crate::image_io::FORMATS;
#[cfg(feature = "device")]
use crate::kernel::{Device, devices};
use crate::kernel::{KernelEntry, Spec, choose};
use crate::lab::Lab;
use crate::material::MATERIALS;
use crate::measure::{COLUMNS, Column, OUTPUTS, WARNINGS, WarningEntry};
use crate::metric::METRICS;
use crate::report::FIGURES;
use crate::sampling::SAMPLERS;
use crate::scene::{ACCELERATORS, CAMERAS, FEATURES, FILTERS, GENERATORS, PROFILES, SHAPES, effect_names};
use crate::simd::LEVELS;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::sync::Arc;

/// `pathmark list strategies --json`
#[derive(Args)]
pub(crate) struct Arguments {
    /// Kind of names to list [default: all]
    kind: Option<Kind>,
    /// List only this name, such as a warning as it stands in a row, with or without its brackets
    name: Option<String>,
    /// Print an array of objects with name and about
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    Scenes,
    Workloads,
    Strategies,
    Decompositions,
    Outputs,
    Estimators,
    Samplers,
    Kernels,
    Simd,
    #[cfg(feature = "device")]
    Devices,
    Effects,
    Accelerators,
    Cameras,
    Filters,
    Shapes,
    Generators,
    Materials,
    Features,
    Metrics,
    Formats,
    Experiments,
    Keys,
    Figures,
    Columns,
    Warnings,
}

impl Kind {
    fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }
}

#[derive(Serialize)]
struct Item {
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<String>,
    name: String,
    about: String,
    /// The remedy for a warning.
    #[serde(skip_serializing_if = "Option::is_none")]
    advice: Option<&'static str>,
    #[serde(flatten)]
    scene: Option<SceneItem>,
}

/// Further facts about a scene.
#[derive(Serialize)]
struct SceneItem {
    calls_for: String,
    profile: &'static str,
    primitives: usize,
    estimator: String,
}

fn item(name: &str, about: &str) -> Item {
    Item { kind: None, name: name.to_string(), about: about.to_string(), advice: None, scene: None }
}

/// Meaning, type and first schema of a column of `records.csv`.
fn about_column(column: &Column) -> String {
    let unit = column.unit().map_or_else(String::new, |unit| format!(" of {unit}"));
    let empty = if column.may_be_empty() { ", may be empty" } else { "" };
    format!("{} [{}{unit}{empty}; since schema {}]", column.about.trim(), column.values(), column.since)
}

/// The name that a driver gives a device, or why there is none.
#[cfg(feature = "device")]
fn about_device(device: &Device) -> String {
    if device.is_there { device.about.clone() } else { format!("none: {}", device.about) }
}

fn scene_item(lab: &Lab, name: &str) -> Result<Item> {
    let scene = lab.load_scene(name)?;
    let choice = choose(&scene, &Spec::default())?;
    let more = SceneItem {
        calls_for: effect_names(scene.effects()),
        profile: choice.profile.name,
        primitives: scene.owners.len(),
        estimator: scene.estimator().to_string(),
    };
    Ok(Item { scene: Some(more), ..item(name, &scene.about) })
}

fn items(lab: &Arc<Lab>, kind: Kind) -> Result<Vec<Item>> {
    Ok(match kind {
        Kind::Scenes => lab.scenes().map(|name| scene_item(lab, name)).collect::<Result<_>>()?,
        Kind::Workloads => lab.workloads().iter().map(|entry| item(entry.name, entry.about())).collect(),
        Kind::Strategies => lab.strategies().iter().map(|entry| item(entry.name, entry.about)).collect(),
        Kind::Decompositions => DECOMPOSITIONS.iter().map(|entry| item(entry.example, entry.about)).collect(),
        Kind::Outputs => OUTPUTS.iter().map(|entry| item(entry.name, entry.about)).collect(),
        Kind::Estimators => lab.estimators().map(|entry| item(entry.name, entry.about)).collect(),
        Kind::Samplers => SAMPLERS.iter().map(|entry| item(entry.name, entry.about)).collect(),
        Kind::Kernels => {
            let named =
                |entry: &KernelEntry| entry.names().iter().map(|name| item(name, entry.about)).collect::<Vec<_>>();
            lab.kernels().iter().flat_map(named).collect()
        }
        Kind::Simd => LEVELS.iter().map(|level| item(level.name, level.about)).collect(),
        #[cfg(feature = "device")]
        Kind::Devices => devices().iter().map(|device| item(&device.id, &about_device(device))).collect(),
        Kind::Effects => PROFILES.iter().map(|entry| item(entry.name, entry.about)).collect(),
        Kind::Accelerators => ACCELERATORS.iter().map(|entry| item(entry.name, entry.about)).collect(),
        Kind::Filters => FILTERS.iter().map(|entry| item(entry.name, entry.about)).collect(),
        Kind::Cameras => CAMERAS.iter().map(|(name, about)| item(name, about)).collect(),
        Kind::Shapes => SHAPES.iter().map(|(name, about)| item(name, about)).collect(),
        Kind::Generators => GENERATORS.iter().map(|(name, about)| item(name, about)).collect(),
        Kind::Features => FEATURES.iter().map(|entry| item(entry.name, entry.about)).collect(),
        Kind::Materials => MATERIALS.iter().map(|entry| item(entry.name, entry.about)).collect(),
        Kind::Metrics => METRICS.iter().map(|entry| item(entry.name, entry.about)).collect(),
        Kind::Formats => FORMATS.iter().map(|entry| item(entry.name, entry.about)).collect(),
        Kind::Experiments => {
            let experiment = |(name, _): (&str, &str)| Ok(item(name, &Definition::load(lab, name)?.title));
            Definition::known(lab).map(experiment).collect::<Result<_>>()?
        }
        Kind::Keys => keys().map(|(key, about)| item(&key, &about)).collect(),
        Kind::Figures => FIGURES.iter().map(|entry| item(entry.name, entry.about)).collect(),
        Kind::Columns => COLUMNS.iter().map(|column| item(column.name, &about_column(column))).collect(),
        Kind::Warnings => {
            let warning = |entry: &WarningEntry| Item { advice: Some(entry.advice), ..item(entry.name, entry.about) };
            WARNINGS.iter().map(warning).collect()
        }
    })
}

/// The item of this name. In rows, the numbers of the case follow a warning's name in brackets.
fn only(mut items: Vec<Item>, kind: Kind, name: &str) -> Result<Item> {
    let wanted = name.split('(').next().unwrap_or_default().trim();
    if let Some(place) = items.iter().position(|item| item.name == wanted) {
        return Ok(items.swap_remove(place));
    }
    let names: Vec<String> = items.into_iter().map(|item| item.name).collect();
    Err(InputError::new("name", name, format!("is none of the {}", kind.name())).allowed(names.join(", ")).into())
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>) -> Result<()> {
    if let Some(kind) = arguments.kind {
        let mut items = items(lab, kind)?;
        if let Some(name) = &arguments.name {
            items = vec![only(items, kind, name)?];
        }
        return if arguments.json { print_json(&items) } else { print(&table(&items)) };
    }
    let mut all = Vec::new();
    for kind in Kind::value_variants() {
        let name = kind.name();
        let listed = items(lab, *kind)?;
        if arguments.json {
            all.extend(listed.into_iter().map(|item| Item { kind: Some(name.clone()), ..item }));
        } else {
            print(&format!("{name}\n{}\n", table(&listed)))?;
        }
    }
    if arguments.json { print_json(&all) } else { Ok(()) }
}

fn table(items: &[Item]) -> String {
    let width = items.iter().map(|item| item.name.len()).max().unwrap_or(0);
    let lines = items.iter().map(|item| {
        let first = format!("  {:width$}  {}", item.name, item.about);
        if let Some(advice) = item.advice {
            return format!("{first}\n  {:width$}    {advice}", "");
        }
        let Some(SceneItem { calls_for, profile, primitives, estimator }) = &item.scene else { return first };
        let primitives = counted(*primitives, "primitive");
        format!("{first}\n  {:width$}    {primitives}, {estimator}, profile {profile}: {calls_for}", "")
    });
    lines.collect::<Vec<_>>().join("\n")
}
