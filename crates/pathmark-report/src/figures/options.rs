//! Options of figures: the table `[figure.NAME]` in an experiment's definition.

use crate::error::Result;
use crate::experiment::Definition;
use crate::input::parse_within;
use crate::results::Results;
use serde::Deserialize;
use serde::de::DeserializeOwned;

/// The options of a figure.
pub(crate) fn options<T: DeserializeOwned + Default>(definition: &Definition, figure: &str) -> Result<T> {
    Ok(parse_within(&definition.text, &definition.file, &["figure", figure])?.unwrap_or_default())
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
