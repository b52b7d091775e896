//! The text of an experiment.
//!
//! ```toml
//! title = "Time against threads"
//! question = "How much faster do more threads make it?"
//! analysis = "How to read the figures."
//! figures = ["speedup"]
//!
//! [matrix]                       # cells are all combinations
//! scene = ["cornell"]
//! estimator = ["smallpt"]
//! spp = [16]
//! seed = [1]
//! strategy = ["serial", "rayon"]
//! threads = [1, 2, "all"]
//! decomposition = ["tiles:32x32"]
//!
//! [reference]                    # optional: measures errors
//! estimator = "bsdf"
//!
//! [quick]                        # what `--quick` renders; any axis of the matrix may be replaced
//! size = [128, 96]
//! repetitions = 6
//! reference-spp = 2000
//!
//! [full]
//! size = [1024, 768]
//! repetitions = 9
//! reference-spp = 2000
//! ```

use super::Cell;
use crate::error::{Error, InputError, Result};
use crate::input::{locate, parse, read_text};
use crate::kernel::Spec;
use crate::measure::{LARGEST_SEED, Settings, Setup, available_threads};
use serde::Deserialize;
use std::path::Path;

/// Name and text of the experiments that the binary carries.
pub const EXPERIMENTS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/experiments.rs"));

/// How large an experiment is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// Small images: minutes.
    Quick,
    /// The report's own sizes: hours.
    Full,
}

impl Profile {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Full => "full",
        }
    }

    /// The profile of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Quick, Self::Full].into_iter().find(|profile| profile.name() == name)
    }
}

/// An experiment as it is written.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Definition {
    /// Name: the file's stem.
    #[serde(skip)]
    pub name: String,
    /// The file's text.
    #[serde(skip)]
    pub text: String,
    /// The file's name, for errors.
    #[serde(skip)]
    pub file: String,
    /// Heading.
    pub title: String,
    /// What is asked.
    pub question: String,
    /// How to read what comes out.
    pub analysis: String,
    /// Names of the figures that the report draws.
    pub figures: Vec<String>,
    /// Whether each cell's first image is kept.
    #[serde(default)]
    pub images: bool,
    matrix: Matrix,
    reference: Option<ReferenceTable>,
    quick: Scale,
    full: Scale,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Matrix {
    scene: Vec<String>,
    estimator: Vec<String>,
    #[serde(default = "independent")]
    sampler: Vec<String>,
    spp: Vec<u32>,
    seed: Vec<u64>,
    strategy: Vec<String>,
    threads: Vec<Threads>,
    decomposition: Vec<String>,
}

fn independent() -> Vec<String> {
    vec!["independent".to_string()]
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct ReferenceTable {
    estimator: String,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Scale {
    size: [u32; 2],
    repetitions: u32,
    reference_spp: Option<u32>,
    spp: Option<Vec<u32>>,
    seed: Option<Vec<u64>>,
    strategy: Option<Vec<String>>,
    threads: Option<Vec<Threads>>,
    decomposition: Option<Vec<String>>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
enum Threads {
    Count(usize),
    Word(ThreadsWord),
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum ThreadsWord {
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
    /// Reads a definition from its text.
    pub fn from_text(name: &str, file: &str, text: &str) -> Result<Self> {
        let mut definition: Self = parse(text, file)?;
        definition.name = name.to_string();
        definition.text = text.to_string();
        definition.file = file.to_string();
        Ok(definition)
    }

    /// The definition of that name in the binary, or the one in the file of that path.
    pub fn load(name_or_path: &str) -> Result<Self> {
        if let Some((name, text)) = EXPERIMENTS.iter().find(|(name, _)| *name == name_or_path) {
            return Self::from_text(name, &format!("{name}.toml"), text);
        }
        let path = Path::new(name_or_path);
        if path.extension().is_none_or(|extension| extension != "toml") {
            let names: Vec<&str> = EXPERIMENTS.iter().map(|(name, _)| *name).collect();
            return Err(InputError::new("experiment", name_or_path, "there is no experiment of that name")
                .allowed(format!("{}, or the path of a .toml file", names.join(", ")))
                .into());
        }
        let stem = path.file_stem().map_or_else(|| name_or_path.into(), |stem| stem.to_string_lossy());
        Self::from_text(&stem, name_or_path, &read_text(path)?)
    }

    fn scale(&self, profile: Profile) -> &Scale {
        match profile {
            Profile::Quick => &self.quick,
            Profile::Full => &self.full,
        }
    }

    /// The estimator that is named first.
    pub fn first_estimator(&self) -> &str {
        self.matrix.estimator.first().map_or("", String::as_str)
    }

    /// How often each cell is run.
    pub fn repetitions(&self, profile: Profile) -> u32 {
        self.scale(profile).repetitions
    }

    /// Estimator and samples per pixel of each half-reference, if errors are to be measured.
    pub fn reference(&self, profile: Profile) -> Result<Option<(String, u32)>> {
        let Some(table) = &self.reference else { return Ok(None) };
        let scale = self.scale(profile);
        let largest = scale.spp.as_ref().unwrap_or(&self.matrix.spp).iter().max().copied().unwrap_or(0);
        let needed = largest.saturating_mul(10);
        match scale.reference_spp {
            Some(spp) if spp >= needed => Ok(Some((table.estimator.clone(), spp))),
            given => {
                let value = given.map_or_else(String::new, |spp| spp.to_string());
                let problem = "each half-reference needs ten times the samples of the largest spp";
                Err(self.located(InputError::new("reference-spp", value, problem).allowed(format!("from {needed}"))))
            }
        }
    }

    /// The cells, each once, in the order of the matrix. Every one has been checked: nothing that the definition says can fail later.
    pub fn cells(&self, profile: Profile) -> Result<Vec<Cell>> {
        let scale = self.scale(profile);
        let matrix = &self.matrix;
        if scale.repetitions == 0 {
            return Err(self.located(InputError::new("repetitions", "0", "must be at least 1")));
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
                            self.add_schedules(scale, scene, *spp, &spec, &mut cells)?;
                        }
                    }
                }
            }
        }
        if cells.is_empty() {
            return Err(self.located(InputError::new("matrix", "", "has an empty axis, so there is nothing to run")));
        }
        Ok(cells)
    }

    /// The cells of one image: everything that may not change its checksum.
    fn add_schedules(&self, scale: &Scale, scene: &str, spp: u32, spec: &Spec, cells: &mut Vec<Cell>) -> Result<()> {
        for strategy in scale.strategy.as_ref().unwrap_or(&self.matrix.strategy) {
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
                        return Err(self.located(error.allowed(format!("0 to {LARGEST_SEED}"))));
                    }
                    let setup = Setup::prepare(settings).map_err(|error| match error {
                        Error::Input(input) if input.place.is_none() => self.located(*input),
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

    /// Adds the place where the field and its value stand in the definition.
    fn located(&self, error: InputError) -> Error {
        let at = locate(&self.text, &error.field, &error.value);
        error.in_file(&self.file, at).into()
    }
}
