//! A cell: settings that are run some number of times.

use crate::kernel::Spec;
use crate::measure::{Settings, Setup, available_threads};

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
        let image = image_word(&setup.scene().name, &settings.spec, settings.spp);
        let spec = &settings.spec;
        let id = format!("{image}/{}/{}/{}t", settings.decomposition, settings.strategy, settings.threads);
        let samples = u64::from(spec.width) * u64::from(spec.height) * u64::from(settings.spp);
        let weight = samples / settings.threads.min(available_threads()) as u64;
        Self { id, settings, image, weight: weight.max(1) }
    }

    /// The file name of its image.
    pub fn image_file(&self) -> String {
        format!("{}.pfm", self.image.replace('/', "-"))
    }
}

fn image_word(scene: &str, spec: &Spec, spp: u32) -> String {
    let what = format!("{scene}/{}/{}", spec.estimator, spec.sampler);
    format!("{what}/{}x{}/{spp}spp/seed{}", spec.width, spec.height, spec.seed)
}
