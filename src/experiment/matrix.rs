//! The axes of an experiment and the cells that they span.

use super::{Cell, Definition, Profile};
use crate::error::{Error, InputError, Result};
use crate::kernel::Spec;
use crate::measure::{LARGEST_SEED, Settings, Setup, available_threads};
use crate::strategy::STRATEGIES;
use serde::Deserialize;
use std::path::Path;

/// The axes; cells are all combinations.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Matrix {
    pub(super) scene: Vec<String>,
    pub(super) estimator: Vec<String>,
    #[serde(default = "independent")]
    pub(super) sampler: Vec<String>,
    pub(super) spp: Vec<u32>,
    pub(super) seed: Vec<u64>,
    pub(super) strategy: Vec<String>,
    pub(super) threads: Vec<Threads>,
    pub(super) decomposition: Vec<String>,
}

fn independent() -> Vec<String> {
    vec!["independent".to_string()]
}

/// How large a profile is, and the axes that it replaces.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct Scale {
    pub(super) size: [u32; 2],
    pub(super) repetitions: u32,
    pub(super) reference_spp: Option<u32>,
    pub(super) spp: Option<Vec<u32>>,
    pub(super) seed: Option<Vec<u64>>,
    pub(super) strategy: Option<Vec<String>>,
    pub(super) threads: Option<Vec<Threads>>,
    pub(super) decomposition: Option<Vec<String>>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(untagged, expecting = "neither a number of threads nor \"all\"")]
pub(super) enum Threads {
    Count(usize),
    Word(ThreadsWord),
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ThreadsWord {
    All,
}

impl Threads {
    fn count(&self) -> usize {
        match self {
            Self::Count(count) => *count,
            Self::Word(ThreadsWord::All) => available_threads(),
        }
    }
}

impl Definition {
    /// The cells, each once, in the order of the matrix. Every one has been checked: nothing that the definition says can fail later.
    pub fn cells(&self, profile: Profile) -> Result<Vec<Cell>> {
        let scale = self.scale(profile);
        let matrix = &self.matrix;
        if scale.repetitions == 0 {
            return Err(self.located(profile, InputError::new("repetitions", "0", "must be at least 1")));
        }
        let empty = [
            ("scene", matrix.scene.is_empty()),
            ("estimator", matrix.estimator.is_empty()),
            ("sampler", matrix.sampler.is_empty()),
            ("spp", scale.spp.as_ref().unwrap_or(&matrix.spp).is_empty()),
            ("seed", scale.seed.as_ref().unwrap_or(&matrix.seed).is_empty()),
            ("strategy", scale.strategy.as_ref().unwrap_or(&matrix.strategy).is_empty()),
            ("threads", scale.threads.as_ref().unwrap_or(&matrix.threads).is_empty()),
            ("decomposition", scale.decomposition.as_ref().unwrap_or(&matrix.decomposition).is_empty()),
        ];
        if let Some((axis, _)) = empty.into_iter().find(|(_, is_empty)| *is_empty) {
            let problem = "is an empty axis, so there is nothing to run";
            return Err(self.located(profile, InputError::new(axis, "[]", problem).allowed("at least one value")));
        }
        let mut cells: Vec<Cell> = Vec::new();
        for scene in &matrix.scene {
            for estimator in &matrix.estimator {
                for sampler in &matrix.sampler {
                    for spp in scale.spp.as_ref().unwrap_or(&matrix.spp) {
                        for seed in scale.seed.as_ref().unwrap_or(&matrix.seed) {
                            let spec = Spec {
                                width: scale.size[0],
                                height: scale.size[1],
                                seed: *seed,
                                estimator: estimator.clone(),
                                sampler: sampler.clone(),
                                ..Spec::default()
                            };
                            self.add_schedules(profile, scene, *spp, &spec, &mut cells)?;
                        }
                    }
                }
            }
        }
        Ok(cells)
    }

    /// The cells of one image: everything that may not change its checksum.
    fn add_schedules(&self, profile: Profile, scene: &str, spp: u32, spec: &Spec, cells: &mut Vec<Cell>) -> Result<()> {
        let scale = self.scale(profile);
        for strategy in all_strategies(scale.strategy.as_ref().unwrap_or(&self.matrix.strategy)) {
            for threads in scale.threads.as_ref().unwrap_or(&self.matrix.threads) {
                for decomposition in scale.decomposition.as_ref().unwrap_or(&self.matrix.decomposition) {
                    let settings = Settings {
                        scene: self.scene_path(scene),
                        spp,
                        spec: spec.clone(),
                        decomposition: decomposition.clone(),
                        strategy: strategy.clone(),
                        threads: threads.count(),
                    };
                    if spec.seed > LARGEST_SEED {
                        let problem = "belongs to the references";
                        let error = InputError::new("seed", spec.seed.to_string(), problem);
                        return Err(self.located(profile, error.allowed(format!("0 to {LARGEST_SEED}"))));
                    }
                    let setup = Setup::prepare(settings).map_err(|error| match error {
                        Error::Input(input) if input.place.is_none() => self.located(profile, *input),
                        other => other,
                    })?;
                    let cell = Cell::new(&setup);
                    if !cells.iter().any(|known| known.id == cell.id) {
                        cells.push(cell);
                    }
                }
            }
        }
        Ok(())
    }

    /// A scene file is named relative to the experiment that uses it.
    fn scene_path(&self, scene: &str) -> String {
        let beside = Path::new(&self.file).parent().map(|folder| folder.join(scene));
        match beside {
            Some(path) if path.extension().is_some_and(|e| e == "toml") && path.is_file() => path.display().to_string(),
            _ => scene.to_string(),
        }
    }
}

/// The names as they stand, `all` being every strategy in the table.
fn all_strategies(names: &[String]) -> impl Iterator<Item = String> {
    let table = || STRATEGIES.iter().map(|entry| entry.name.to_string()).collect();
    names.iter().flat_map(move |name| if name == "all" { table() } else { vec![name.clone()] })
}
