//! `pathmark list [KIND [NAME]]`: all names that a user can choose from, or one of them.

use super::prelude::*;
use crate::experiment::{Definition, keys};
use crate::film::DECOMPOSITIONS;
use crate::image_io::FORMATS;
#[cfg(feature = "device")]
use crate::kernel::{Device, devices};
use crate::kernel::{KernelEntry, Spec, choose};
use crate::material::MATERIALS;
use crate::measure::{COLUMNS, Column, OUTPUTS, WARNINGS, WarningEntry};
use crate::metric::METRICS;
use crate::report::FIGURES;
use crate::sampling::SAMPLERS;
use crate::scene::{ACCELERATORS, CAMERAS, FEATURES, FILTERS, GENERATORS, PROFILES, SCENE_KEYS, SHAPES, effect_names};
use crate::simd::LEVELS;
use crate::strategy::Entry as Strategy;
use clap::builder::PossibleValuesParser;

/// `pathmark list strategies --json`
#[derive(Args)]
pub(crate) struct Arguments {
    /// Kind of names to list [default: all]
    #[arg(value_parser = PossibleValuesParser::new(KINDS.iter().map(|(name, _)| *name)))]
    kind: Option<String>,
    /// List only this name, such as a warning as it stands in a row, with or without its brackets; or the keys of this
    /// table, as in `list keys scene` and `list keys scene.camera`
    name: Option<String>,
    /// Print an array of objects with name and about
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Item {
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<&'static str>,
    name: String,
    about: String,
    /// Whether the program added it; `grade` asks for the strategies that it did.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    own: bool,
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
    Item { kind: None, name: name.to_string(), about: about.to_string(), own: false, advice: None, scene: None }
}

/// Meaning, type and first schema of a column of `records.csv`.
fn about_column(column: &Column) -> String {
    let unit = column.unit().map_or_else(String::new, |unit| format!(" of {unit}"));
    let empty = if column.may_be_empty() { ", may be empty" } else { "" };
    format!("{} [{}{unit}{empty}]", column.about.trim(), column.values())
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

/// The items of a table whose entries have a name and a meaning.
macro_rules! named {
    ($table:expr) => {
        |_| Ok($table.iter().map(|entry| item(entry.name, entry.about)).collect())
    };
}

/// Lists the items of a kind.
type Items = fn(&Arc<Lab>) -> Result<Vec<Item>>;

/// Each kind of names.
const KINDS: &[(&str, Items)] = &[
    ("scenes", |lab| lab.scenes().map(|name| scene_item(lab, name)).collect()),
    ("workloads", |lab| Ok(lab.workloads().iter().map(|entry| item(entry.name, entry.about())).collect())),
    ("strategies", |lab| {
        let strategy =
            |entry: &Strategy| Item { own: lab.is_own("strategy", entry.name), ..item(entry.name, entry.about) };
        Ok(lab.strategies().iter().map(strategy).collect())
    }),
    ("decompositions", |_| Ok(DECOMPOSITIONS.iter().map(|entry| item(entry.example, entry.about)).collect())),
    ("outputs", named!(OUTPUTS)),
    ("estimators", |lab| Ok(lab.estimators().map(|entry| item(entry.name, entry.about)).collect())),
    ("samplers", named!(SAMPLERS)),
    ("kernels", |lab| {
        let named = |entry: &KernelEntry| entry.names().iter().map(|name| item(name, entry.about)).collect::<Vec<_>>();
        Ok(lab.kernels().iter().flat_map(named).collect())
    }),
    ("simd", named!(LEVELS)),
    #[cfg(feature = "device")]
    ("devices", |_| {
        let about = |device: &Device| format!("{}{}", if device.is_there { "" } else { "none: " }, device.about);
        Ok(devices().iter().map(|device| item(&device.id, &about(device))).collect())
    }),
    ("effects", named!(PROFILES)),
    ("accelerators", named!(ACCELERATORS)),
    ("cameras", |_| Ok(CAMERAS.iter().map(|(name, about)| item(name, about)).collect())),
    ("filters", named!(FILTERS)),
    ("shapes", |_| Ok(SHAPES.iter().map(|(name, about)| item(name, about)).collect())),
    ("generators", |_| Ok(GENERATORS.iter().map(|(name, about)| item(name, about)).collect())),
    ("materials", named!(MATERIALS)),
    ("features", named!(FEATURES)),
    ("metrics", named!(METRICS)),
    ("formats", named!(FORMATS)),
    ("experiments", |lab| {
        let experiment = |(name, _): (&str, &str)| Ok(item(name, &Definition::load(lab, name)?.title));
        Definition::known(lab).map(experiment).collect()
    }),
    ("keys", |_| {
        let of_scenes = SCENE_KEYS.iter().map(|key| item(&format!("scene.{}", key.path), &key.in_words()));
        Ok(keys().map(|(key, about)| item(&key, &about)).chain(of_scenes).collect())
    }),
    ("figures", named!(FIGURES)),
    ("columns", |_| Ok(COLUMNS.iter().map(|column| item(column.name, &about_column(column))).collect())),
    ("warnings", |_| {
        let warning = |entry: &WarningEntry| Item { advice: Some(entry.advice), ..item(entry.name, entry.about) };
        Ok(WARNINGS.iter().map(warning).collect())
    }),
];

/// The item of this name, and the keys below it. In rows, the numbers of the case follow a warning's name in brackets.
fn named(items: Vec<Item>, kind: &str, name: &str) -> Result<Vec<Item>> {
    let wanted = name.split('(').next().unwrap_or_default().trim();
    let is_wanted =
        |item: &Item| item.name.strip_prefix(wanted).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    let (found, others): (Vec<Item>, Vec<Item>) = items.into_iter().partition(is_wanted);
    if !found.is_empty() {
        return Ok(found);
    }
    let names: Vec<String> = others.into_iter().map(|item| item.name).collect();
    Err(InputError::new("name", name, format!("is none of the {kind}")).allowed(names.join(", ")).into())
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>) -> Result<()> {
    if let Some((kind, items)) = KINDS.iter().find(|(name, _)| arguments.kind.as_deref() == Some(name)) {
        let mut items = items(lab)?;
        if let Some(name) = &arguments.name {
            items = named(items, kind, name)?;
        }
        return if arguments.json { print_json(&items) } else { print(&table(&items)) };
    }
    let mut all = Vec::new();
    for (name, items) in KINDS {
        let listed = items(lab)?;
        if arguments.json {
            all.extend(listed.into_iter().map(|item| Item { kind: Some(name), ..item }));
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
