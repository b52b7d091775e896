//! The axes of an experiment and the cells that they span.

use super::definition::FEATURES;
use super::{Cell, Definition, Profile};
use crate::error::{Error, InputError, Result};
use crate::kernel::{Clamp, Spec};
use crate::measure::{ImageKey, LARGEST_SEED, ScheduleKey, Settings, Setup, available_threads};
use crate::sampling::{SAMPLERS, is_deterministic};
use crate::simd::{Level, levels};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::HashSet;
use std::fmt;
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
    #[serde(default = "slots")]
    pub(super) output: Vec<String>,
    #[serde(default = "lanes")]
    pub(super) kernel: Vec<String>,
    /// Instruction sets of lanes; `all` is every one that this processor has.
    #[serde(default = "fitting")]
    pub(super) simd: Vec<String>,
    /// Floating-point formats; they give other images.
    #[serde(default = "double")]
    pub(super) precision: Vec<String>,
    #[serde(default = "fitting")]
    pub(super) effects: Vec<String>,
    #[serde(default = "fitting")]
    pub(super) accelerator: Vec<String>,
    #[serde(default = "fitting")]
    pub(super) roulette: Vec<String>,
    /// Where paths are cut; nowhere if it is empty.
    #[serde(default, rename = "max-depth")]
    pub(super) max_depth: Vec<u16>,
    /// Instead of the profile's.
    pub(super) size: Option<[u32; 2]>,
    /// Whether samples per pixel are for each thread.
    #[serde(default)]
    pub(super) weak: bool,
    /// Whether each cell is a curve: a render that is measured on its way.
    #[serde(default)]
    pub(super) curve: bool,
    /// What is clamped to 1.
    pub(super) clamp: Option<Clamp>,
}

fn double() -> Vec<String> {
    vec![Spec::default().precision]
}

fn independent() -> Vec<String> {
    vec!["independent".to_string()]
}

fn lanes() -> Vec<String> {
    vec![Spec::default().kernel]
}

/// Whatever fits the scene best.
const FITTING: &str = "fitting";

fn fitting() -> Vec<String> {
    vec![FITTING.to_string()]
}

/// The name, unless it leaves the choice open.
fn unless_fitting(name: &str) -> Option<String> {
    (name != FITTING).then(|| name.to_string())
}

fn slots() -> Vec<String> {
    vec!["slots".to_string()]
}

/// One table, or an array of them.
pub(super) fn one_or_many<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Vec<Matrix>, D::Error> {
    struct OneOrMany;
    impl<'de> Visitor<'de> for OneOrMany {
        type Value = Vec<Matrix>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a table [matrix] or several [[matrix]]")
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> std::result::Result<Self::Value, A::Error> {
            Ok(vec![Matrix::deserialize(MapAccessDeserializer::new(map))?])
        }

        fn visit_seq<A: SeqAccess<'de>>(self, sequence: A) -> std::result::Result<Self::Value, A::Error> {
            Vec::deserialize(SeqAccessDeserializer::new(sequence))
        }
    }
    deserializer.deserialize_any(OneOrMany)
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

/// Cells that differ. Two words may mean the same run, as the profile that fits a scene and its name do; a point that two curves share is one.
#[derive(Default)]
struct Cells {
    list: Vec<Cell>,
    known: HashSet<(ImageKey, ScheduleKey)>,
}

impl Cells {
    /// Adds what a setup gives and is not there yet.
    fn add(&mut self, setup: &Setup, is_curve: bool) {
        let mut cell = if is_curve { Cell::curve(setup) } else { Cell::new(setup) };
        let (image, schedule) = (setup.image_key(), setup.schedule_key());
        let known = &mut self.known;
        cell.points.retain(|point| known.insert((ImageKey { spp: point.spp, ..image.clone() }, schedule.clone())));
        if !cell.points.is_empty() {
            self.list.push(cell);
        }
    }
}

impl Definition {
    /// The cells, each once, in the order of the matrix. Every one has been checked: nothing that the definition says can fail later.
    pub fn cells(&self, profile: Profile) -> Result<Vec<Cell>> {
        if self.scale(profile).repetitions == 0 {
            return Err(self.located(profile, InputError::new("repetitions", "0", "must be at least 1")));
        }
        if let Some(unknown) = self.requires.iter().find(|name| !FEATURES.iter().any(|(known, _)| known == name)) {
            let names: Vec<&str> = FEATURES.iter().map(|(name, _)| *name).collect();
            let error = InputError::new("requires", unknown, "there is no feature of that name");
            return Err(self.located(profile, error.allowed(names.join(", "))));
        }
        if let Some(feature) = self.missing_feature() {
            let error = InputError::new("requires", feature, "is a feature that this program was built without");
            return Err(
                self.located(profile, error.allowed(format!("cargo run --release --features {feature} -- ...")))
            );
        }
        let mut cells = Cells::default();
        for matrix in &self.matrix {
            self.add_images(profile, matrix, &mut cells)?;
        }
        cells.list.extend(self.external_cells(profile)?);
        Ok(cells.list)
    }

    /// The cells of one matrix.
    fn add_images(&self, profile: Profile, matrix: &Matrix, cells: &mut Cells) -> Result<()> {
        let scale = self.scale(profile);
        let size = matrix.size.unwrap_or(scale.size);
        let (spps, seeds) = (scale.spp.as_ref().unwrap_or(&matrix.spp), scale.seed.as_ref().unwrap_or(&matrix.seed));
        let empty = [
            ("scene", matrix.scene.is_empty()),
            ("estimator", matrix.estimator.is_empty()),
            ("sampler", matrix.sampler.is_empty()),
            ("output", matrix.output.is_empty()),
            ("kernel", matrix.kernel.is_empty()),
            ("simd", matrix.simd.is_empty()),
            ("precision", matrix.precision.is_empty()),
            ("effects", matrix.effects.is_empty()),
            ("accelerator", matrix.accelerator.is_empty()),
            ("spp", spps.is_empty()),
            ("seed", seeds.is_empty()),
            ("strategy", scale.strategy.as_ref().unwrap_or(&matrix.strategy).is_empty()),
            ("threads", scale.threads.as_ref().unwrap_or(&matrix.threads).is_empty()),
            ("decomposition", scale.decomposition.as_ref().unwrap_or(&matrix.decomposition).is_empty()),
        ];
        if let Some((axis, _)) = empty.into_iter().find(|(_, is_empty)| *is_empty) {
            let problem = "is an empty axis, so there is nothing to run";
            return Err(self.located(profile, InputError::new(axis, "[]", problem).allowed("at least one value")));
        }
        let levels = all_of(&matrix.simd, levels().map(Level::name));
        let depths: Vec<Option<u16>> = match matrix.max_depth.as_slice() {
            [] => vec![None],
            depths => depths.iter().copied().map(Some).collect(),
        };
        for scene in &all_of(&matrix.scene, self.lab.scenes()) {
            for estimator in &self.estimators(profile, matrix, scene)? {
                for sampler in &matrix.sampler {
                    self.check_sampler(profile, sampler)?;
                    for (max_depth, spp, seed) in depths
                        .iter()
                        .flat_map(|d| spps.iter().flat_map(move |n| seeds.iter().map(move |s| (*d, *n, *s))))
                    {
                        let spec = Spec {
                            width: size[0],
                            height: size[1],
                            seed,
                            estimator: estimator.clone(),
                            sampler: sampler.clone(),
                            max_depth,
                            clamp: matrix.clamp,
                            ..Spec::default()
                        };
                        let image = Settings { scene: self.scene_path(scene), spp, spec, ..Settings::default() };
                        let kernels = matrix.kernel.iter().flat_map(|k| {
                            levels.iter().flat_map(move |s| matrix.precision.iter().map(move |p| (k, s, p)))
                        });
                        let rules = matrix.effects.iter().flat_map(|e| {
                            matrix.accelerator.iter().flat_map(move |a| matrix.roulette.iter().map(move |r| (e, a, r)))
                        });
                        for ((kernel, simd, precision), (effects, accelerator, roulette)) in
                            kernels.flat_map(|kernel| rules.clone().map(move |rules| (kernel, rules)))
                        {
                            let mut image = image.clone();
                            image.spec.kernel.clone_from(kernel);
                            image.spec.simd = unless_fitting(simd);
                            image.spec.precision.clone_from(precision);
                            image.spec.roulette = unless_fitting(roulette);
                            image.spec.effects = unless_fitting(effects);
                            image.spec.accelerator = unless_fitting(accelerator);
                            self.add_schedules(profile, matrix, &image, cells)?;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// The estimators for a scene; `default` is the one that it names itself.
    fn estimators(&self, profile: Profile, matrix: &Matrix, scene: &str) -> Result<Vec<String>> {
        let own = || match self.lab.load_scene(&self.scene_path(scene)) {
            _ if self.lab.workload_named(scene).is_some() => Ok(String::new()),
            Ok(scene) => Ok(scene.default_estimator.unwrap_or(Spec::default().estimator)),
            Err(Error::Input(input)) if input.place.is_none() => Err(self.located(profile, *input)),
            Err(other) => Err(other),
        };
        matrix.estimator.iter().map(|name| if name == "default" { own() } else { Ok(name.clone()) }).collect()
    }

    /// Every row's checksum is compared with the others' of the same image, unless the definition says that there is none.
    fn check_sampler(&self, profile: Profile, sampler: &str) -> Result<()> {
        if self.unverified || is_deterministic(sampler) || !SAMPLERS.iter().any(|entry| entry.name == sampler) {
            return Ok(());
        }
        let problem = "gives other numbers in each run, and a checksum is expected here";
        let names: Vec<&str> = SAMPLERS.iter().filter(|entry| entry.deterministic).map(|entry| entry.name).collect();
        let allowed = format!("{}; or unverified = true in the definition", names.join(", "));
        Err(self.located(profile, InputError::new("sampler", sampler, problem).allowed(allowed)))
    }

    /// The cells of one image: everything that may not change its checksum.
    fn add_schedules(&self, profile: Profile, matrix: &Matrix, image: &Settings, cells: &mut Cells) -> Result<()> {
        let scale = self.scale(profile);
        if image.spec.seed > LARGEST_SEED {
            let error = InputError::new("seed", image.spec.seed.to_string(), "belongs to the references");
            return Err(self.located(profile, error.allowed(format!("0 to {LARGEST_SEED}"))));
        }
        let strategies = scale.strategy.as_ref().unwrap_or(&matrix.strategy);
        for strategy in all_of(strategies, self.lab.strategies().iter().map(|entry| entry.name)) {
            for threads in scale.threads.as_ref().unwrap_or(&matrix.threads).iter().map(Threads::count) {
                for decomposition in scale.decomposition.as_ref().unwrap_or(&matrix.decomposition) {
                    for output in &matrix.output {
                        let scaled = u32::try_from(threads).unwrap_or(u32::MAX);
                        let settings = Settings {
                            spp: if matrix.weak { image.spp.saturating_mul(scaled) } else { image.spp },
                            decomposition: decomposition.clone(),
                            output: output.clone(),
                            strategy: strategy.clone(),
                            threads,
                            ..image.clone()
                        };
                        let at_field = |error| match error {
                            Error::Input(input) if input.place.is_none() => self.located(profile, *input),
                            other => other,
                        };
                        let setup = self.lab.prepare(settings).map_err(at_field)?;
                        if matrix.curve {
                            setup.check_rounds().map_err(at_field)?;
                        }
                        cells.add(&setup, matrix.curve);
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

/// The names as they stand, `all` being every one in the table.
fn all_of<'a>(names: &[String], table: impl Iterator<Item = &'a str>) -> Vec<String> {
    let every: Vec<String> = table.map(str::to_string).collect();
    names.iter().flat_map(|name| if name == "all" { every.clone() } else { vec![name.clone()] }).collect()
}
