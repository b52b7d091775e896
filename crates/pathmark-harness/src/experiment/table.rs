//! The tables of a definition that give values to axes: `[matrix]`, and a table for each profile.

use super::definition::REFERENCE_SPP;
use super::second_stage::SecondStage;
use super::stopping_rule::{MOST_REPETITIONS, StoppingRule};
use super::{Profile, Timeout};
use crate::input::array;
use crate::measure::{Kind, SETTINGS, Setting, available_threads};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{DeserializeSeed, Error as _, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;
use std::num::NonZeroU32;
use std::str::FromStr;

/// A table: the values of axes as text, and the other fields of a matrix or a profile.
#[derive(Debug, Clone, Default)]
pub(super) struct Table<const PROFILE: bool> {
    axes: BTreeMap<&'static str, Vec<String>>,
    /// Whether samples per pixel are for each thread.
    pub(super) weak: bool,
    /// Whether each cell is a curve: a render that is measured several times on its way.
    pub(super) curve: bool,
    /// The profiles that the matrix is for; all, if `None`.
    pub(super) profiles: Option<Vec<Profile>>,
    /// The repetitions of each cell; the largest number, if there is a goal, and those of the first stage, if there are
    /// two.
    pub(super) repetitions: u32,
    /// The largest number of repetitions of the matrix's cells.
    pub(super) at_most: Option<u32>,
    pub(super) until: Option<StoppingRule>,
    pub(super) second_stage: Option<SecondStage>,
    pub(super) reference_spp: Option<u32>,
    /// Pairs of a process, where cells are compared.
    pub(super) pairs: Option<u32>,
    pub(super) timeout: Option<Timeout>,
}

/// The axes; cells are all combinations. An axis that is not named keeps its default.
pub(super) type Matrix = Table<false>;

/// The size and repetitions of a profile, and the axes that it replaces.
pub(super) type Scale = Table<true>;

/// The axes that a matrix cannot leave out.
pub(super) const REQUIRED: &[&str] = &["scene", "spp", "strategy", "threads", "decomposition"];

/// The axis that ends renders by time.
pub(super) const TIME_LIMIT: &str = "time-limit";

const TIMEOUT: &str = "timeout";

/// The field of a profile for the pairs of a process.
const PAIRS: &str = "pairs";

/// Default size and repetitions of a profile: the fewest repetitions that allow an interval with 95 % confidence.
const SIZE: &str = "320x240";
const REPETITIONS: u32 = 6;

impl Matrix {
    pub(super) fn is_for(&self, profile: Profile) -> bool {
        self.profiles.as_ref().is_none_or(|profiles| profiles.contains(&profile))
    }
}

impl Scale {
    pub(super) fn usual() -> Self {
        Self { axes: BTreeMap::from([("size", vec![SIZE.to_string()])]), repetitions: REPETITIONS, ..Self::default() }
    }
}

impl<const PROFILE: bool> Table<PROFILE> {
    pub(super) fn values(&self, axis: &str) -> Option<&Vec<String>> {
        self.axes.get(axis)
    }

    pub(super) fn numbers<T: FromStr>(&self, axis: &str) -> Option<Vec<T>> {
        Some(self.values(axis)?.iter().filter_map(|value| value.parse().ok()).collect())
    }
}

/// The repetitions of a profile: a number, a goal, or two stages.
#[derive(Deserialize)]
#[serde(
    untagged,
    deny_unknown_fields,
    expecting = "expected a number, { until = \"3 %\", at-most = 200, max-time = \"60 s\" } or { at-least = 16, at-most = 48, max-time = \"2 min\" }"
)]
enum Repetitions {
    Count(u32),
    #[serde(rename_all = "kebab-case")]
    StoppingRule {
        until: String,
        at_most: Option<u32>,
        #[serde(alias = "within")]
        max_time: Option<String>,
    },
    #[serde(rename_all = "kebab-case")]
    Stages {
        at_least: u32,
        at_most: u32,
        max_time: Option<String>,
    },
}

struct Key<const PROFILE: bool>(String);

impl<'de, const PROFILE: bool> Deserialize<'de> for Key<PROFILE> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let others: &[&str] = if PROFILE {
            &["repetitions", REFERENCE_SPP, TIMEOUT, PAIRS]
        } else {
            &["repetitions", "weak", "curve", "profiles"]
        };
        let known: Vec<&str> = SETTINGS.iter().map(|axis| axis.name).chain(others.iter().copied()).collect();
        if known.contains(&name.as_str()) {
            return Ok(Self(name));
        }
        Err(D::Error::custom(format_args!("unknown field `{name}`, expected one of `{}`", known.join("`, `"))))
    }
}

struct Values(&'static Setting);

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number of threads or \"all\"")]
enum Threads {
    Count(usize),
    Word(ThreadsWord),
}

#[derive(Deserialize)]
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

fn words<T: ToString>(values: &[T]) -> Vec<String> {
    values.iter().map(ToString::to_string).collect()
}

impl<'de> DeserializeSeed<'de> for Values {
    type Value = Vec<String>;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Self::Value, D::Error> {
        Ok(match self.0.kind {
            Kind::Name | Kind::Auto => Vec::deserialize(from)?,
            Kind::Switch => words(&Vec::<bool>::deserialize(from)?),
            Kind::Count => words(&Vec::<u16>::deserialize(from)?),
            Kind::Samples => words(&Vec::<u32>::deserialize(from)?),
            Kind::Seconds => words(&Vec::<f64>::deserialize(from)?),
            Kind::Seed => words(&Vec::<u64>::deserialize(from)?),
            Kind::Workers => Vec::<Threads>::deserialize(from)?.iter().map(|own| own.count().to_string()).collect(),
            // All cells have the same size, so it is not a list.
            Kind::Size => array(from).map(|[width, height]: [u32; 2]| vec![format!("{width}x{height}")])?,
        })
    }
}

impl<'de, const PROFILE: bool> Deserialize<'de> for Table<PROFILE> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(TableVisitor)
    }
}

struct TableVisitor<const PROFILE: bool>;

impl<'de, const PROFILE: bool> Visitor<'de> for TableVisitor<PROFILE> {
    type Value = Table<PROFILE>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Self::Value, M::Error> {
        let usual = if PROFILE { Scale::usual() } else { Scale::default() };
        let mut table = Table::<PROFILE> { axes: usual.axes, repetitions: usual.repetitions, ..Table::default() };
        while let Some(Key(name)) = map.next_key::<Key<PROFILE>>()? {
            match (Setting::named(&name), name.as_str()) {
                (Some(axis), _) => _ = table.axes.insert(axis.name, map.next_value_seed(Values(axis))?),
                (None, "weak") => table.weak = map.next_value()?,
                (None, "curve") => table.curve = map.next_value()?,
                (None, "profiles") => table.profiles = Some(map.next_value()?),
                (None, "repetitions") if !PROFILE => table.at_most = Some(map.next_value::<NonZeroU32>()?.get()),
                (None, "repetitions") => match map.next_value()? {
                    Repetitions::Count(count) => (table.repetitions, table.until) = (count, None),
                    Repetitions::StoppingRule { until, at_most, max_time } => {
                        table.repetitions = at_most.unwrap_or(MOST_REPETITIONS);
                        table.until = Some(StoppingRule::parse(&until, max_time.as_deref()).map_err(M::Error::custom)?);
                    }
                    Repetitions::Stages { at_least, at_most, max_time } => {
                        let stage = SecondStage::parse(at_least, at_most, max_time.as_deref());
                        table.second_stage = Some(stage.map_err(M::Error::custom)?);
                        table.repetitions = at_least;
                    }
                },
                (None, PAIRS) => table.pairs = Some(map.next_value::<NonZeroU32>()?.get()),
                (None, TIMEOUT) => table.timeout = Some(map.next_value()?),
                (None, _) => table.reference_spp = Some(map.next_value()?),
            }
        }
        match REQUIRED.iter().find(|required| !PROFILE && !table.axes.contains_key(*required)) {
            Some(missing) => Err(M::Error::missing_field(missing)),
            None => Ok(table),
        }
    }
}

pub(super) fn one_or_many<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<Vec<T>, D::Error> {
    struct OneOrMany<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for OneOrMany<T> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a table [matrix] or several [[matrix]]")
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
            Ok(vec![T::deserialize(MapAccessDeserializer::new(map))?])
        }

        fn visit_seq<A: SeqAccess<'de>>(self, sequence: A) -> Result<Self::Value, A::Error> {
            Vec::deserialize(SeqAccessDeserializer::new(sequence))
        }
    }
    deserializer.deserialize_any(OneOrMany(PhantomData))
}
