//! Definitions: the text of an experiment. `pathmark list keys` explains every key.
//!
//! ```toml
//! title = "Time against threads"
//! question = "How much faster do more threads make it?"
//! figures = ["speedup"]
//!
//! [matrix]                       # cells are all combinations; there may be several, each under [[matrix]]
//! scene = ["cornell"]
//! spp = [16]
//! strategy = ["serial", "rayon"]
//! threads = [1, 2, "all"]
//! decomposition = ["tiles:32x32"]
//!
//! [[compare]]                    # cells that run side by side, in adjacent pairs (see `comparisons`)
//! with = { strategy = ["serial"] }
//!
//! [quick]                        # what `--quick` renders; the profile may replace any axis of the matrices
//! size = [128, 96]
//! repetitions = 6                # processes, where cells are compared; `pairs` are then those of each process
//! ```

use super::comparisons::Compare;
use super::second_stage::SecondStage;
use super::stopping_rule::StoppingRule;
use super::table::{Matrix, Scale, TIME_LIMIT, one_or_many};
use super::texts::experiments;
use super::{External, Profile, Timeout};
use crate::error::{Error, InputError, Result};
use crate::input::{locate, locate_in, parse, read_text};
use crate::lab::Lab;
use crate::shell;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::fmt;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;

/// The field of a profile for the samples of each half-reference.
pub(super) const REFERENCE_SPP: &str = "reference-spp";

/// Other names in a folder of results, which no experiment may have.
const TAKEN: &[&str] = &[
    "CLAIMS.md",
    "bursts",
    "check",
    "claims",
    "earlier",
    "guards",
    "index",
    "pages",
    "references",
    "replication",
    "report.html",
];

/// The features that not every build has, and whether this one has them. An experiment may require them.
pub(super) const FEATURES: [(&str, bool); 3] = [
    ("openmp", cfg!(feature = "openmp")),
    ("more-pools", cfg!(feature = "more-pools")),
    ("lane-profiles", cfg!(feature = "lane-profiles")),
];

/// A chapter of the report page. Each experiment names its chapter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Chapter {
    Accuracy,
    Scheduling,
    /// Guards, and inputs on which simpler programs fail.
    HardInputs,
    Effects,
    /// Experiments that name no chapter.
    #[default]
    Others,
}

impl Chapter {
    pub const ALL: [Self; 5] = [Self::Accuracy, Self::Scheduling, Self::HardInputs, Self::Effects, Self::Others];

    pub fn anchor(self) -> &'static str {
        match self {
            Self::Accuracy => "chapter-accuracy",
            Self::Scheduling => "chapter-scheduling",
            Self::HardInputs => "chapter-hard-inputs",
            Self::Effects => "chapter-effects",
            Self::Others => "chapter-others",
        }
    }

    pub fn title(self) -> &'static str {
        match self {
            Self::Accuracy => "What accuracy costs in time",
            Self::Scheduling => "Who runs what when: scheduling",
            Self::HardInputs => "What stays right on hard inputs",
            Self::Effects => "Effects only where a scene calls for them",
            Self::Others => "Other experiments",
        }
    }
}

/// Files that a sweep may keep beside its rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Keep {
    /// The image of each cell's first repetition.
    Images,
    Traces,
    /// The costs of handing out empty jobs, which the simulator needs.
    Calibration,
    /// The costs of messages between processes, which the simulator needs for ranks.
    Messages,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Definition {
    /// Name: the file's stem.
    #[serde(skip)]
    pub name: String,
    #[serde(skip)]
    pub text: String,
    #[serde(skip)]
    pub file: String,
    /// The name or path by which it was loaded.
    #[serde(skip)]
    pub(super) asked: String,
    /// The values that `--set` gave; with any, no line of the text is one of the file.
    #[serde(skip)]
    pub(super) set: Vec<String>,
    #[serde(skip, default = "Lab::built_in")]
    pub lab: Arc<Lab>,
    pub title: String,
    pub question: String,
    #[serde(default)]
    pub analysis: String,
    #[serde(default)]
    pub chapter: Chapter,
    /// Its place in the chapter. Experiments without a place follow those with one, by name.
    #[serde(default = "last_place")]
    pub place: u32,
    /// The number of the finding, from 1, that stands at the beginning of the page.
    #[serde(default, rename = "in-short")]
    pub in_short: Option<NonZeroUsize>,
    pub figures: Vec<String>,
    /// Parameters of figures, by figure; each figure reads its own table.
    #[serde(default, deserialize_with = "parameters")]
    pub figure: BTreeMap<String, toml::Table>,
    #[serde(default)]
    pub keep: Vec<Keep>,
    /// Whether samplers may draw other random numbers in each run, so that no checksum can be expected.
    #[serde(default)]
    pub unverified: bool,
    pub(super) timeout: Option<Timeout>,
    /// Features that not every build has; without them the experiment is left out.
    #[serde(default)]
    pub requires: Vec<String>,
    #[serde(deserialize_with = "one_or_many")]
    pub(super) matrix: Vec<Matrix>,
    /// The cells that run side by side.
    #[serde(default)]
    pub(super) compare: Vec<Compare>,
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

/// The tables of parameters. The key differs by one letter from the list of figures, so its error names both.
struct Parameters;

impl<'de> Visitor<'de> for Parameters {
    type Value = BTreeMap<String, toml::Table>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table [figure.NAME] of parameters; did you mean `figures`, the list of names?")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> std::result::Result<Self::Value, A::Error> {
        BTreeMap::deserialize(MapAccessDeserializer::new(map))
    }
}

fn parameters<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<BTreeMap<String, toml::Table>, D::Error> {
    deserializer.deserialize_map(Parameters)
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct ReferenceTable {
    estimator: String,
    object: Option<String>,
}

impl Definition {
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
    pub fn missing_feature(&self) -> Option<(&'static str, String)> {
        let required = |name: &str| self.requires.iter().any(|required| required == name);
        let missing = FEATURES.iter().find(|(name, is_there)| required(name) && !is_there);
        missing.map(|(name, _)| (*name, shell::build_with(name)))
    }

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

    pub(super) fn second_stage(&self, profile: Profile) -> Result<Option<&SecondStage>> {
        Ok(self.scale(profile)?.second_stage.as_ref())
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
        // A time limit ends renders at numbers of samples that nobody knows in advance.
        let is_limited = |table: Option<&Vec<String>>| table.is_some_and(|limits| !limits.is_empty());
        let is_open = is_limited(scale.values(TIME_LIMIT))
            || self.matrices(profile).any(|matrix| is_limited(matrix.values(TIME_LIMIT)));
        if spp >= needed || is_open && scale.reference_spp.is_some() {
            return Ok(Some((table.estimator.clone(), spp)));
        }
        let problem = format!("each half-reference needs {times} times the samples of the largest spp");
        let error = InputError::new(REFERENCE_SPP, spp.to_string(), problem).allowed(format!("at least {needed}"));
        Err(self.located(profile, error))
    }

    /// The object on whose pixels errors are measured, too.
    pub fn object(&self) -> Option<&str> {
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
