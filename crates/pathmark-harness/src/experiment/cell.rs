//! A cell: settings that are run some number of times.

use super::{External, SceneVersion};
use crate::error::{InputError, Result};
use crate::measure::{ImageKey, SETTINGS, ScheduleKey, Setting, Settings, Setup, available_threads, schedule_name};

/// One combination of the experiment's matrix.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// The settings in one word: the key by which a resumed sweep finds its finished rows.
    pub id: String,
    pub settings: Settings,
    /// The scene as it was when the cell was made.
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

/// A row of a cell.
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
    /// Its repetitions in an experiment of `others` repetitions.
    pub(super) fn repetitions(&self, others: u32) -> u32 {
        self.at_most.map_or(others, |most| most.min(others))
    }

    /// Whether it runs its jobs one after the other on one thread.
    pub(super) fn is_serial(&self) -> bool {
        self.settings.is_serial()
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

pub fn trace_file(cell: &str, repetition: u32) -> String {
    format!("{}-r{repetition}.csv", cell.replace(['/', ':'], "-"))
}
