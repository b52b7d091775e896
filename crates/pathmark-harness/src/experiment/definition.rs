//! Definitions: the text of an experiment.
//!
//! ```toml
//! title = "Time against threads"
//! question = "How much faster do more threads make it?"
//! analysis = "How to read the figures."   # optional
//! figures = ["speedup"]
//! chapter = "scheduling"          # optional: accuracy, scheduling, hard-inputs or effects; where the page has it
//! place = 3                       # optional: its place among the experiments of the chapter
//! in-short = 1                    # optional: the number of the finding that stands at the beginning of the page
//! keep = ["traces"]               # optional: images, traces, calibration, messages
//! timeout = "10min"               # optional: the time limit of each cell's process, or "none"; a profile may have another
//!
//! [matrix]                       # cells are all combinations
//! scene = ["cornell"]            # or "all"
//! estimator = ["smallpt"]        # or "default", the scene's own, which is meant without this line
//! spp = [16]
//! seed = [1]                     # optional
//! strategy = ["serial", "rayon"]  # or "all"
//! threads = [1, 2, "all"]
//! decomposition = ["tiles:32x32"]
//! # There may be several, each under [[matrix]]. Optional: sampler, output, effects, accelerator, roulette, max-depth, size (instead of the
//! # profile's), kernel, simd, precision, adaptive, clamp, filter, epsilon, weak = true, which gives each cell spp times its threads, and curve = true, which gives a row at 1, 2, 4 ... times the
//! # fewest samples on the way to each spp. profiles = ["reports"] is for a matrix that other profiles do not have, and repetitions = 3 for one
//! # whose cells are run no more often.
//!
//! [[compare]]                    # optional: cells that run side by side, in adjacent pairs (see `comparisons`)
//! what = { threads = [2] }       # optional: all cells
//! with = { strategy = ["serial"] }
//! goal = "2 %"                   # optional: half of the interval that each ratio should have
//!
//! [figure.price-list]            # optional: what a figure of the list above is told
//! goals = [0.1, 0.01]
//!
//! [reference]                    # optional: measures errors
//! estimator = "bsdf"
//! object = "mirror ball"          # optional: and those on the pixels of this object (column object_mse)
//!
//! [quick]                        # what `--quick` renders; the profile may replace any axis of the matrices
//! size = [128, 96]
//! pairs = 16                     # optional: of each process, if there are comparisons; repetitions then count processes
//! repetitions = 6                # or { until = "3 %", at-most = 200, max-time = "60 s" }; until = "fastest" or "order" compares schedules
//! reference-spp = 2000           # optional: ten times the largest spp
//!
//! [full]                         # `--full`; without any of [quick], [full] and [reports] there is a [quick] of 320x240, 6 repetitions
//! size = [1024, 768]
//! repetitions = 9
//! reference-spp = 2000
//!
//! [reports]                      # `--reports`: sizes and parameters of the reports
//! size = [1024, 768]
//! repetitions = 1
//! reference-spp = 2000
//! ```

use super::comparisons::Compare;
use super::stopping_rule::StoppingRule;
use super::table::{Matrix, Scale, one_or_many};
use super::texts::experiments;
use super::{Chapter, External, Profile, Timeout};
use crate::error::{Error, InputError, Result};
use crate::input::{locate, locate_in, parse, read_text};
use crate::lab::Lab;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;

/// The field of a profile for the samples of each half-reference.
pub(super) const REFERENCE_SPP: &str = "reference-spp";

/// Other names in a folder of results, which no experiment may have.
const TAKEN: &[&str] = &["CLAIMS.md", "benches", "check", "claims", "earlier", "guards", "references", "report.html"];

/// A feature that not every build has.
pub(super) struct Feature {
    /// Its name in an experiment's `requires`.
    pub(super) name: &'static str,
    /// Whether this build has it.
    pub(super) is_there: bool,
    /// How to get a build that has it.
    pub(super) takes: &'static str,
}

/// The features that an experiment may require.
pub(super) const FEATURES: &[Feature] = &[
    Feature {
        name: "openmp",
        is_there: cfg!(feature = "openmp"),
        takes: "a program built by `cargo run --release --features openmp -- ...`",
    },
    Feature {
        name: "more-pools",
        is_there: cfg!(feature = "more-pools"),
        takes: "a program built by `cargo run --release --features more-pools -- ...`",
    },
];

/// Files that a sweep may keep beside its rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Keep {
    /// The image of each cell's first repetition.
    Images,
    /// The trace of each run.
    Traces,
    /// The costs of handing out empty jobs, which the simulator needs.
    Calibration,
    /// The costs of messages between processes, which the simulator needs for ranks.
    Messages,
}

/// An experiment as its file defines it.
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
    /// The name or path by which it was loaded.
    #[serde(skip)]
    pub(super) asked: String,
    /// The values that `--set` gave; with any, no line of the text is one of the file.
    #[serde(skip)]
    pub(super) set: Vec<String>,
    /// The tables in which its names are looked up.
    #[serde(skip, default = "Lab::built_in")]
    pub lab: Arc<Lab>,
    /// Heading.
    pub title: String,
    pub question: String,
    /// How to read the results.
    #[serde(default)]
    pub analysis: String,
    /// The chapter of the report page that it belongs to.
    #[serde(default)]
    pub chapter: Chapter,
    /// Its place in the chapter. Experiments without a place follow those with one, by name.
    #[serde(default = "last_place")]
    pub place: u32,
    /// The number of the finding, from 1, that stands at the beginning of the page.
    #[serde(default, rename = "in-short")]
    pub in_short: Option<NonZeroUsize>,
    /// Names of the figures that the report draws.
    pub figures: Vec<String>,
    /// Parameters of figures, by figure; each figure reads its own table.
    #[serde(default)]
    pub figure: BTreeMap<String, toml::Table>,
    /// The files that are kept beside the rows.
    #[serde(default)]
    pub keep: Vec<Keep>,
    /// Whether samplers may draw other random numbers in each run, so that no checksum can be expected.
    #[serde(default)]
    pub unverified: bool,
    /// The time limit of each cell, where the profile sets none.
    pub(super) timeout: Option<Timeout>,
    /// Features that not every build has; without them the experiment is left out.
    #[serde(default)]
    pub requires: Vec<String>,
    #[serde(deserialize_with = "one_or_many")]
    pub(super) matrix: Vec<Matrix>,
    /// What runs side by side.
    #[serde(default)]
    pub(super) compare: Vec<Compare>,
    /// Other programs.
    #[serde(default)]
    pub external: Vec<External>,
    reference: Option<ReferenceTable>,
    pub(super) quick: Option<Scale>,
    pub(super) full: Option<Scale>,
    pub(super) reports: Option<Scale>,
}

fn last_place() -> u32 {
    u32::MAX
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct ReferenceTable {
    estimator: String,
    object: Option<String>,
}

impl Definition {
    /// Reads a definition from its text.
    pub fn from_text(lab: &Arc<Lab>, name: &str, file: &str, text: &str) -> Result<Self> {
        let mut definition: Self = parse(text, file)?;
        definition.lab = Arc::clone(lab);
        definition.name = name.to_string();
        definition.text = text.to_string();
        definition.file = file.to_string();
        if definition.profiles().next().is_none() {
            definition.quick = Some(Scale::usual());
        }
        definition.check_profiles()?;
        Ok(definition)
    }

    /// Name and text of the definitions that are known by name: those in the binary, then those that a program added.
    pub fn known(lab: &Lab) -> impl Iterator<Item = (&str, &str)> {
        experiments().iter().chain(lab.own_experiments()).map(|(name, text)| (name.as_str(), text.as_str()))
    }

    /// Loads the definition with that name, or from the file at that path.
    pub fn load(lab: &Arc<Lab>, name_or_path: &str) -> Result<Self> {
        let definition = Self { asked: name_or_path.to_string(), ..Self::find(lab, name_or_path)? };
        let name = &definition.name;
        if Path::new(name).file_name().is_none_or(|own| *own != **name) || TAKEN.contains(&name.as_str()) {
            let problem = format!("names the experiment `{name}`, which cannot be the name of its folder");
            return Err(InputError::new("experiment", name_or_path, problem).allowed("another file name").into());
        }
        Ok(definition)
    }

    fn find(lab: &Arc<Lab>, name_or_path: &str) -> Result<Self> {
        if let Some((name, text)) = Self::known(lab).find(|(name, _)| *name == name_or_path) {
            return Self::from_text(lab, name, &format!("{name}.toml"), text);
        }
        let path = Path::new(name_or_path);
        if path.extension().is_none_or(|extension| extension != "toml") {
            let names: Vec<&str> = Self::known(lab).map(|(name, _)| name).collect();
            return Err(InputError::new("experiment", name_or_path, "there is no experiment of that name")
                .allowed(format!("{}, or the path of a .toml file", names.join(", ")))
                .into());
        }
        let stem = path.file_stem().map_or_else(|| name_or_path.into(), |stem| stem.to_string_lossy());
        Self::from_text(lab, &stem, name_or_path, &read_text(path)?)
    }

    /// The estimator that is named first; empty if none is named.
    pub fn first_estimator(&self) -> &str {
        self.matrix.iter().filter_map(|matrix| matrix.values("estimator")).flatten().next().map_or("", String::as_str)
    }

    /// The estimators, in the order in which they are named, and then the other programs.
    pub fn estimator_names(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        let own = self.matrix.iter().filter_map(|matrix| matrix.values("estimator")).flatten();
        for name in own.chain(self.external.iter().map(|external| &external.name)) {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        names
    }

    /// The first required feature that this build lacks, and how to get it.
    pub fn missing_feature(&self) -> Option<(&str, &'static str)> {
        let required = |feature: &&Feature| self.requires.iter().any(|name| name == feature.name);
        let missing = FEATURES.iter().filter(required).find(|feature| !feature.is_there);
        missing.map(|feature| (feature.name, feature.takes))
    }

    /// Whether these files are kept beside the rows.
    pub fn keeps(&self, what: Keep) -> bool {
        self.keep.contains(&what)
    }

    /// The repetitions of each cell; the largest number, if there is a goal.
    pub fn repetitions(&self, profile: Profile) -> Result<u32> {
        Ok(self.scale(profile)?.repetitions)
    }

    /// The time limit of each cell; `None` if the definition sets none.
    pub(super) fn timeout(&self, profile: Profile) -> Result<Option<Timeout>> {
        Ok(self.scale(profile)?.timeout.or(self.timeout))
    }

    /// The goal at which repetitions stop; `None` if their number is fixed.
    pub(super) fn until(&self, profile: Profile) -> Result<Option<&StoppingRule>> {
        Ok(self.scale(profile)?.until.as_ref())
    }

    /// Pairs of a process, where cells are compared.
    pub(super) fn pairs(&self, profile: Profile) -> Result<Option<u32>> {
        Ok(self.scale(profile)?.pairs)
    }

    pub(super) fn matrices(&self, profile: Profile) -> impl Iterator<Item = &Matrix> {
        self.matrix.iter().filter(move |matrix| matrix.is_for(profile))
    }

    /// Estimator and samples per pixel of each half-reference, if errors are to be measured.
    pub fn reference(&self, profile: Profile) -> Result<Option<(String, u32)>> {
        let Some(table) = &self.reference else { return Ok(None) };
        let scale = self.scale(profile)?;
        let own = || self.matrices(profile).filter_map(|matrix| matrix.numbers("spp")).flatten().collect();
        let spps: Vec<u32> = scale.numbers("spp").unwrap_or_else(own);
        let largest = spps.into_iter().max().unwrap_or(0);
        // All seeds share the references' noise, which the cross form removes only in the mean. In curves this matters
        // less, because the last point is one of many.
        let times = if self.matrices(profile).all(|matrix| matrix.curve) { 4 } else { 10 };
        let needed = largest.saturating_mul(times);
        let spp = scale.reference_spp.unwrap_or(needed);
        if spp >= needed {
            return Ok(Some((table.estimator.clone(), spp)));
        }
        let problem = format!("each half-reference needs {times} times the samples of the largest spp");
        let error = InputError::new(REFERENCE_SPP, spp.to_string(), problem).allowed(format!("at least {needed}"));
        Err(self.located(profile, error))
    }

    /// The object on whose pixels errors are measured, too.
    pub(super) fn object(&self) -> Option<&str> {
        self.reference.as_ref()?.object.as_deref()
    }

    /// Adds to the error of a reference the place of the field that caused it.
    pub(super) fn reference_error(&self, profile: Profile, error: Error) -> Error {
        match error {
            Error::Input(mut input) if input.place.is_none() && input.field == "spp" => {
                input.field = REFERENCE_SPP.to_string();
                self.located(profile, *input)
            }
            Error::Input(input) if input.place.is_none() => {
                let at = locate_in("reference", &self.text, &input.field, &input.value);
                input.in_file(&self.file, at.filter(|_| self.set.is_empty())).into()
            }
            other => other,
        }
    }

    /// Adds the place of the field and its value in the definition. The profile's own table is searched before the
    /// rest.
    pub(super) fn located(&self, profile: Profile, error: InputError) -> Error {
        if !self.set.is_empty() {
            return error.in_file(&self.file, None).into();
        }
        let (text, key, value) = (&self.text, &error.field, &error.value);
        let at = locate_in(profile.name(), text, key, value).or_else(|| locate(text, key, value));
        error.in_file(&self.file, at).into()
    }
}
