//! A cell: settings that are run some number of times.

use crate::error::{InputError, Result};
use crate::kernel::Spec;
use crate::measure::{Settings, Setup, available_threads, schedule_name};
use crate::scene::Scene;

/// One combination of the experiment's matrix.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// The settings in one word: the key under which a killed sweep finds what it has done.
    pub id: String,
    /// The settings.
    pub settings: Settings,
    /// What tells images apart: cells with the same word must have the same checksum.
    pub image: String,
    /// Samples that one of this machine's processors has to render: how long it takes, in the same unit for all cells.
    pub weight: u64,
}

impl Cell {
    /// The cell of a setup. What a strategy ignores does not tell cells apart.
    pub fn new(setup: &Setup) -> Self {
        let mut settings = setup.settings().clone();
        settings.threads = setup.threads();
        let image = image_word(setup.scene(), &settings.spec, settings.spp);
        let spec = &settings.spec;
        let mut id = format!("{image}/{}/{}/{}t", settings.decomposition, settings.strategy, settings.threads);
        if settings.output != Settings::default().output {
            id = format!("{id}/{}", settings.output);
        }
        for (axis, value) in [("effects", &spec.effects), ("accelerator", &spec.accelerator)] {
            if let Some(value) = value {
                id = format!("{id}/{axis}-{value}");
            }
        }
        let samples = u64::from(spec.width) * u64::from(spec.height) * u64::from(settings.spp);
        let weight = samples / settings.threads.min(available_threads()) as u64;
        Self { id, settings, image, weight: weight.max(1) }
    }

    /// Whether it has the value that a filter `field=value` asks for.
    pub fn matches(&self, filter: &str) -> Result<bool> {
        let (settings, spec) = (&self.settings, &self.settings.spec);
        let fields = [
            ("scene", settings.scene.clone()),
            ("estimator", spec.estimator.clone()),
            ("sampler", spec.sampler.clone()),
            ("spp", settings.spp.to_string()),
            ("seed", spec.seed.to_string()),
            ("decomposition", settings.decomposition.clone()),
            ("output", settings.output.clone()),
            ("effects", spec.effects.clone().unwrap_or_default()),
            ("accelerator", spec.accelerator.clone().unwrap_or_default()),
            ("max-depth", spec.max_depth.map(|depth| depth.to_string()).unwrap_or_default()),
            ("roulette", spec.roulette().unwrap_or_default()),
            ("strategy", schedule_name(&settings.strategy, &settings.decomposition).to_string()),
            ("threads", settings.threads.to_string()),
        ];
        let pair = filter.split_once('=');
        let known = pair.and_then(|(field, value)| Some((fields.iter().find(|(name, _)| *name == field)?, value)));
        known.map(|((_, own), value)| own == value).ok_or_else(|| {
            let names: Vec<&str> = fields.iter().map(|(name, _)| *name).collect();
            InputError::new("filter", filter, "names no field")
                .allowed(format!("{}=VALUE", names.join("=VALUE, ")))
                .into()
        })
    }

    /// The file name of its image.
    pub fn image_file(&self) -> String {
        format!("{}.pfm", self.image.replace(['/', ':'], "-"))
    }
}

/// The file name of the trace of a cell's repetition.
pub fn trace_file(cell: &str, repetition: u32) -> String {
    format!("{}-r{repetition}.csv", cell.replace(['/', ':'], "-"))
}

/// The scene's hash is in it: two scene files may have the same name, and one may be edited between two runs.
fn image_word(scene: &Scene, spec: &Spec, spp: u32) -> String {
    let what = format!("{}-{}/{}/{}", scene.name, scene.hash, spec.estimator, spec.sampler);
    let depth = spec.max_depth.map(|depth| format!("/depth{depth}")).unwrap_or_default();
    let roulette = spec.roulette.as_ref().map(|rule| format!("/{rule}")).unwrap_or_default();
    format!("{what}/{}x{}/{spp}spp/seed{}{depth}{roulette}", spec.width, spec.height, spec.seed)
}
