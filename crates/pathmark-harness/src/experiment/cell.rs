//! A cell: settings that are run some number of times, and the version of its scene.

use super::External;
use crate::error::{InputError, Result};
use crate::measure::{ImageKey, SETTINGS, ScheduleKey, Setting, Settings, Setup, available_threads, schedule_name};
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::path::PathBuf;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// The settings in one word: the key by which a resumed sweep finds its finished rows.
    pub id: String,
    pub settings: Settings,
    pub scene: SceneVersion,
    /// Its rows: one, or the points of its curve, in the order of samples per pixel.
    pub points: Vec<CellPoint>,
    /// Samples for each processor of this machine: an estimate of its time, in the same unit for all cells.
    pub weight: u64,
    /// The most repetitions that its matrix allows; `None` without a limit.
    pub at_most: Option<u32>,
    /// The other program that renders it, if it is not this one.
    pub external: Option<External>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CellPoint {
    /// Its key. For a point of a curve: the key of a cell with so many samples, followed by the name of the curve.
    pub id: String,
    pub spp: u32,
    /// The image in one word: rows with the same word must have the same checksum.
    pub image: String,
}

impl CellPoint {
    pub fn image_file(&self) -> String {
        format!("{}.pfm", self.image.replace(['/', ':'], "-"))
    }
}

impl Cell {
    pub(super) fn repetitions(&self, others: u32) -> u32 {
        self.at_most.map_or(others, |most| most.min(others))
    }

    /// Its settings without its schedule. A serial run with the same ones, and any decomposition, is its baseline.
    pub(super) fn without_schedule(&self) -> Settings {
        Settings {
            strategy: String::new(),
            threads: 0,
            rank_rule: None,
            ranks: None,
            decomposition: String::new(),
            ..self.settings.clone()
        }
    }

    /// The cell of a setup. Settings that its strategy ignores do not tell cells apart.
    pub fn new(setup: &Setup) -> Self {
        Self::with_points(setup, &[setup.settings().spp], "")
    }

    /// The cell of a curve: one long render that is measured at 1, 2, 4 ... times the fewest samples that make an image, and at its end.
    pub fn curve(setup: &Setup) -> Self {
        let (spp, multiple) = (setup.settings().spp, setup.fewest_spp());
        let doubled = std::iter::successors(Some(multiple), |spp| spp.checked_mul(2)).take_while(|own| *own < spp);
        let points: Vec<u32> = doubled.chain([spp]).collect();
        Self::with_points(setup, &points, &format!("/curve-{spp}"))
    }

    fn with_points(setup: &Setup, points: &[u32], of: &str) -> Self {
        let mut settings = setup.settings().clone();
        settings.threads = setup.threads();
        let spec = &settings.spec;
        let schedule = ScheduleKey::id_of(&settings);
        let point = |spp: u32| {
            let image = ImageKey { spp, ..setup.image_key() }.to_string();
            CellPoint { id: format!("{image}/{schedule}{of}"), spp, image }
        };
        let id = point(settings.spp).id;
        let points = points.iter().map(|spp| point(*spp)).collect();
        let samples = u64::from(spec.width) * u64::from(spec.height) * u64::from(settings.spp);
        let weight = samples / settings.workers(settings.threads).min(available_threads()) as u64;
        let scene = SceneVersion::of(setup);
        Self { id, points, weight: weight.max(1), at_most: None, external: None, scene, settings }
    }

    /// Its value on an axis, as filters compare it.
    pub fn shown(&self, axis: &Setting) -> String {
        let strategy = schedule_name(&self.settings.strategy, &self.settings.decomposition).to_string();
        axis.show(&Settings { strategy, ..self.settings.clone() })
    }

    /// Whether it has one of the values that a filter `field=value,value...` asks for.
    pub fn matches(&self, filter: &str) -> Result<bool> {
        let pair = filter.split_once('=');
        let known = pair.and_then(|(field, value)| Some((Setting::named(field)?, value)));
        known.map(|(axis, values)| values.split(',').any(|value| self.shown(axis) == value)).ok_or_else(|| {
            let names: Vec<&str> = SETTINGS.iter().map(|setting| setting.name).collect();
            InputError::new("filter", filter, "does not begin with the name of an axis")
                .allowed(format!("{}=VALUE", names.join("=VALUE, ")))
                .into()
        })
    }
}

/// The chosen cells, and the serial runs that they are compared with if they are, in the order of all cells.
pub(super) fn with_serial_runs(cells: &[Cell], chosen: &[&Cell], are_compared: bool) -> Vec<Cell> {
    let ids: HashSet<&str> = chosen.iter().map(|cell| cell.id.as_str()).collect();
    let compared: HashSet<Settings> = chosen.iter().map(|cell| cell.without_schedule()).collect();
    let is_needed =
        |cell: &Cell| are_compared && cell.settings.is_serial() && compared.contains(&cell.without_schedule());
    cells.iter().filter(|cell| ids.contains(cell.id.as_str()) || is_needed(cell)).cloned().collect()
}

pub fn trace_file(cell: &str, repetition: u32) -> String {
    format!("{}-r{repetition}.csv", cell.replace(['/', ':'], "-"))
}

/// A scene as it was when an experiment began, meshes and bases included. Its files may be edited while the experiment
/// runs. Rows of two versions are no repetitions of each other, and are not measured against each other's references.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct SceneVersion {
    pub hash: String,
    pub files: Vec<PathBuf>,
}

impl SceneVersion {
    pub fn of(setup: &Setup) -> Self {
        Self { hash: setup.hash(), files: setup.files().to_vec() }
    }

    /// Refuses another hash: the scene has changed since this version was read.
    pub fn check(&self, hash: &str) -> Result<()> {
        if hash == self.hash {
            return Ok(());
        }
        let files: Vec<String> = self.files.iter().map(|file| file.display().to_string()).collect();
        let problem = format!("has changed since the experiment began: its hash was {}", self.hash);
        let error = InputError::new("scene_hash", hash, problem);
        Err(error.in_file(files.join(" or "), None).into())
    }
}
