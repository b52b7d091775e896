//! Statistics that a claim may ask for: a closed list.

use super::condition::{Column, Conditions};
use crate::error::{InputError, Result};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::fmt;
use toml::{Table, Value};

/// A number that is computed from results.
#[derive(Debug)]
pub(super) enum Statistic {
    /// A statistic of the rows of an experiment.
    OfRows { experiment: String, rows: Conditions, unit: Unit, kind: Kind },
    /// The number of some hard cases that failed.
    Case(Cases),
    /// A value in the price list of the guards.
    Guard(GuardValue),
}

/// A number that is computed from rows, as a claim writes it.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Kind {
    /// A column, or the sum of two, perhaps divided by another.
    Value { column: Column, plus: Option<Column>, per: Option<Column> },
    /// The sum of a column.
    Count { column: Column },
    /// The ratio of a column between paired rows.
    PairedRatio { column: Column, over: Conditions },
    /// The baseline's time over the rows' own, in pairs: of the makespan, or of another column of seconds.
    Speedup { over: Conditions, column: Option<Column> },
    /// The slope of log y against log x.
    Exponent { x: Column, y: Column },
    /// The slope of log RMSE against log spp, with an interval over seeds.
    RmseSlope {},
    /// The ratio of two means over seeds. The claim that they are equal is confirmed if both one-sided tests reject a ratio
    /// beyond the margin (see `mean_ratio`).
    MeanRatio { column: Column, over: Conditions },
    /// Spearman's rank correlation of two columns, each averaged within groups.
    RankCorrelation { x: Column, y: Column, by: Column },
    /// The largest number of different checksums of one image.
    Checksum {},
    /// A simulated schedule on many cores.
    Forecast { strategy: String, cores: usize, column: ForecastColumn },
}

/// The independent units of a statistic: all values of one unit make one value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Unit {
    /// A repetition of a run, for times: its rows share the condition of the machine, and pairs may share a process or a
    /// denominator.
    #[default]
    Repetition,
    /// A seed, for properties of images: each run and repetition renders the same image again.
    Seed,
    /// A scene, for claims about scenes.
    Scene,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ForecastColumn {
    Speedup,
    Efficiency,
    SerialFraction,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Cases {
    pub(super) ids: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GuardValue {
    pub(super) guard: String,
    pub(super) column: GuardColumn,
}

/// A column of the price list.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum GuardColumn {
    ErrorWith,
    ErrorWithout,
    TimeRatio,
}

/// The fields of every statistic of rows, and those of its kind.
#[derive(Deserialize)]
struct OfRows {
    experiment: String,
    #[serde(default)]
    rows: Conditions,
    #[serde(default)]
    unit: Unit,
    #[serde(flatten)]
    fields: Table,
}

impl Kind {
    /// The columns that it asks for, each with the field that names it.
    fn columns(&self) -> Vec<(&'static str, &str)> {
        let own: Vec<(&'static str, Option<&Column>)> = match self {
            Self::Value { column, plus, per } => {
                vec![("column", Some(column)), ("plus", plus.as_ref()), ("per", per.as_ref())]
            }
            Self::Count { column } | Self::PairedRatio { column, .. } | Self::MeanRatio { column, .. } => {
                vec![("column", Some(column))]
            }
            Self::Speedup { column, .. } => vec![("column", column.as_ref())],
            Self::Exponent { x, y } => vec![("x", Some(x)), ("y", Some(y))],
            Self::RankCorrelation { x, y, by } => vec![("x", Some(x)), ("y", Some(y)), ("by", Some(by))],
            Self::RmseSlope {} | Self::Checksum {} | Self::Forecast { .. } => Vec::new(),
        };
        let over = self.over().into_iter().flat_map(Conditions::columns).map(|column| ("over", column));
        own.into_iter().filter_map(|(field, column)| Some((field, &**column?))).chain(over).collect()
    }

    /// The rows that it compares with.
    pub(super) fn over(&self) -> Option<&Conditions> {
        match self {
            Self::PairedRatio { over, .. } | Self::Speedup { over, .. } | Self::MeanRatio { over, .. } => Some(over),
            _ => None,
        }
    }

    /// Whether it asks for columns that only this program's rows have.
    pub(super) fn is_of_own_rows(&self) -> bool {
        matches!(
            self,
            Self::RmseSlope {} | Self::Checksum {} | Self::Forecast { .. } | Self::Speedup { column: None, .. }
        )
    }
}

/// The statistics of another program's rows.
pub(super) const OF_PLAIN_ROWS: &str =
    "value, count, paired-ratio, speedup with a column, exponent, mean-ratio, rank-correlation";

/// The names of the statistics that are not of rows.
const OTHERS: [&str; 2] = ["case", "guard"];

/// The fields of the statistics of rows, whatever their kind.
const OF_ROWS: [&str; 3] = ["experiment", "rows", "unit"];

/// The statistics with their own fields; those of rows also have [`OF_ROWS`].
const FIELDS: [(&str, &[&str]); 12] = [
    ("value", &["column", "plus", "per"]),
    ("count", &["column"]),
    ("paired-ratio", &["column", "over"]),
    ("speedup", &["over", "column"]),
    ("exponent", &["x", "y"]),
    ("rmse-slope", &[]),
    ("mean-ratio", &["column", "over"]),
    ("rank-correlation", &["x", "y", "by"]),
    ("checksum", &[]),
    ("forecast", &["strategy", "cores", "column"]),
    ("case", &["ids"]),
    ("guard", &["guard", "column"]),
];

/// The fields of the statistic of that name; `None` if there is no such statistic.
pub(super) fn fields_of(name: &str) -> Option<Vec<&'static str>> {
    let (_, own) = FIELDS.iter().find(|(known, _)| *known == name)?;
    let shared = if OTHERS.contains(&name) { &[][..] } else { &OF_ROWS };
    Some(shared.iter().chain(*own).copied().collect())
}

/// Whether any statistic has this field.
pub(super) fn is_field_of_any(field: &str) -> bool {
    OF_ROWS.contains(&field) || FIELDS.iter().any(|(_, own)| own.contains(&field))
}

impl Statistic {
    /// The columns that it asks for, each with the field that names it.
    pub(super) fn columns(&self) -> Vec<(&'static str, &str)> {
        match self {
            Self::OfRows { rows, kind, .. } => {
                rows.columns().map(|column| ("rows", column)).chain(kind.columns()).collect()
            }
            Self::Case(_) | Self::Guard(_) => Vec::new(),
        }
    }

    /// The statistic of that name with these fields.
    pub(super) fn of(name: &str, fields: &Table) -> Result<Self> {
        let [case, guard] = OTHERS;
        if name == case {
            let cases: Cases = read(name, fields)?;
            if cases.ids.is_empty() {
                return Err(InputError::new("ids", "", "names no hard case")
                    .allowed("names of `pathmark selftest`")
                    .into());
            }
            return Ok(Self::Case(cases));
        }
        if name == guard {
            return Ok(Self::Guard(read(name, fields)?));
        }
        let OfRows { experiment, rows, unit, fields } = read(name, fields)?;
        // The name is a key here: with a tag among the fields, serde would not tell the key of a wrong value.
        let kind = read(name, &Table::from_iter([(name.to_string(), Value::Table(fields))]))?;
        Ok(Self::OfRows { experiment, rows, unit, kind })
    }
}

/// Reads a table of a claim. An error is about the field that serde names, or else about the statistic.
fn read<T: DeserializeOwned>(statistic: &str, table: &Table) -> Result<T> {
    table.clone().try_into().map_err(|error: toml::de::Error| {
        let said = error.to_string();
        let (problem, path) = said.split_once("\nin `").unwrap_or((&said, ""));
        let (problem, allowed) = problem.trim().split_once(", expected one of ").unwrap_or((problem.trim(), ""));
        let own = table.get(statistic).and_then(Value::as_table).unwrap_or(table);
        let field = path.trim_end().trim_end_matches('`').split('.').find_map(|key| own.get_key_value(key));
        let allowed = match field {
            None if problem.starts_with("unknown variant") => format!("{allowed}, {}", OTHERS.join(", ")),
            _ => allowed.to_string(),
        };
        let (field, value) = field.map_or(("statistic", statistic.to_string()), |(key, value)| (key, shown(value)));
        InputError::new(field, value, problem).allowed(allowed.replace('`', "")).into()
    })
}

/// A value as a claim writes it, a text without its quotes.
fn shown(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_string)
}

impl GuardColumn {
    fn name(self) -> &'static str {
        match self {
            Self::ErrorWith => "error with it",
            Self::ErrorWithout => "error without it",
            Self::TimeRatio => "time with it over time without it",
        }
    }
}

/// Writes the statistic in words, with its rows.
impl fmt::Display for Statistic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Case(Cases { ids }) => write!(f, "failed among the hard cases {}", ids.join(", ")),
            Self::Guard(GuardValue { guard, column }) => write!(f, "{} of the guard \"{guard}\"", column.name()),
            Self::OfRows { experiment, rows, kind, .. } if rows.is_empty() => {
                write!(f, "{kind}; all rows of {experiment}")
            }
            Self::OfRows { experiment, rows, kind, .. } => write!(f, "{kind}; rows of {experiment} where {rows}"),
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value { column, plus, per } => {
                let sum = plus.as_ref().map_or_else(|| column.to_string(), |plus| format!("({column} + {plus})"));
                write!(f, "{sum}{}", per.as_ref().map_or_else(String::new, |per| format!(" / {per}")))
            }
            Self::Count { column } => write!(f, "sum of {column}"),
            Self::PairedRatio { column, over } => write!(f, "ratio of {column} to that of rows where {over}"),
            Self::Speedup { over, column } => {
                let of = column.as_ref().map_or_else(String::new, |column| format!(" of {column}"));
                write!(f, "speedup{of} against rows where {over}")
            }
            Self::Exponent { x, y } => write!(f, "exponent of {y} against {x}"),
            Self::RmseSlope {} => f.write_str("exponent of rmse against spp"),
            Self::MeanRatio { column, over } => write!(f, "ratio of mean {column} to that of rows where {over}"),
            Self::RankCorrelation { x, y, by } => write!(f, "rank correlation of {y} with {x} by {by}"),
            Self::Checksum {} => f.write_str("largest number of checksums of one image"),
            Self::Forecast { strategy, cores, column } => {
                write!(f, "simulated {} of {strategy} on {cores} cores", column.name())
            }
        }
    }
}

impl ForecastColumn {
    fn name(self) -> &'static str {
        match self {
            Self::Speedup => "speedup",
            Self::Efficiency => "efficiency",
            Self::SerialFraction => "serial fraction",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names in a message of serde.
    fn named(message: &str) -> Vec<&str> {
        message.split('`').skip(1).step_by(2).collect()
    }

    /// The list has each statistic with the fields that it reads.
    #[test]
    fn the_list_of_fields_is_that_of_the_statistics() {
        let wrong = Statistic::of("no-such", &toml::toml! { experiment = "e" }).unwrap_err().to_string();
        assert!(FIELDS.iter().all(|(name, _)| wrong.contains(name)), "{wrong}");
        let count = wrong.split_once("allowed: ").unwrap().1.split(", ").count();
        assert_eq!(count, FIELDS.len(), "{wrong}");
        for (name, own) in FIELDS {
            let fields = if OTHERS.contains(&name) {
                Table::new()
            } else {
                toml::toml! { experiment = "e" }
            };
            let fields = fields.into_iter().chain([("no-such".to_string(), Value::Integer(1))]).collect();
            let Err(crate::error::Error::Input(error)) = Statistic::of(name, &fields) else { panic!("{name}") };
            let known: Vec<String> =
                named(&error.problem).into_iter().chain(error.allowed.split(", ")).map(str::to_string).collect();
            let known: Vec<&str> =
                known.iter().map(String::as_str).filter(|own| !["no-such", ""].contains(own)).collect();
            assert_eq!(known, own, "{name}: {error}");
        }
    }
}
