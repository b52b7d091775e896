//! Options of figures: the table `[figure.NAME]` in an experiment's definition.

use crate::error::Result;
use crate::experiment::Definition;
use crate::input::parse_within;
use crate::results::Results;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// The options of a figure. A definition without such a table, as in old folders, gets the options of the experiment of
/// the same name that the program contains.
pub(crate) fn options<T: DeserializeOwned + Default>(definition: &Definition, figure: &str) -> Result<T> {
    let path = ["figure", figure];
    if definition.figure.contains_key(figure) {
        return Ok(parse_within(&definition.text, &definition.file, &path)?.unwrap_or_default());
    }
    let built_in = Definition::known(&definition.lab).find(|(name, _)| *name == definition.name);
    let found = built_in.map_or(Ok(None), |(name, text)| parse_within(text, &format!("{name}.toml"), &path))?;
    Ok(found.unwrap_or_default())
}

/// Refuses options that a figure does not have.
pub(crate) fn check<T: DeserializeOwned + Default>(definition: &Definition, figure: &str) -> Result<()> {
    options(definition, figure).map(|_: T| ())
}

/// The options of a figure that has none.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct NoOptions {}

/// The options of a figure that compares all others with one.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct Yardstick {
    yardstick: Option<String>,
}

/// The name of the yardstick, which the others are compared with.
pub(crate) fn yardstick(results: &Results, figure: &str, default: &str) -> Result<String> {
    let found: Yardstick = options(&results.definition, figure)?;
    Ok(found.yardstick.unwrap_or_else(|| default.to_string()))
}

/// A number above zero.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "f64")]
pub(crate) struct Positive(pub(crate) f64);

impl TryFrom<f64> for Positive {
    type Error = &'static str;

    fn try_from(value: f64) -> std::result::Result<Self, Self::Error> {
        if value > 0.0 && value.is_finite() { Ok(Self(value)) } else { Err("must be a positive number") }
    }
}
