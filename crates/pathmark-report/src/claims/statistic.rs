//! Statistics that a claim may ask for: a closed list.

use super::condition::{Conditions, check_column};
use super::definition::Claim;
use crate::error::{InputError, Result};
use std::fmt;

/// A number that is computed from results.
#[derive(Debug)]
pub(super) enum Statistic {
    /// A statistic of the rows of an experiment.
    OfRows { experiment: String, rows: Conditions, kind: Kind },
    /// The number of these hard cases that failed.
    Case { ids: Vec<String> },
    /// A value in the price list of the guards.
    Guard { guard: String, column: GuardColumn },
}

/// A number that is computed from rows.
#[derive(Debug)]
pub(super) enum Kind {
    /// The median of a column, or of one column divided by another.
    Value { column: String, per: Option<String> },
    /// The mean over rows of a column's share of another.
    Share { column: String, of: String },
    /// The sum of a column.
    Count { column: String },
    /// The median ratio of a column between paired rows.
    PairedRatio { column: String, over: Conditions },
    /// The median of the baseline's time over the rows' own, in pairs.
    Speedup { over: Conditions },
    /// The slope of log y against log x.
    Exponent { x: String, y: String },
    /// The slope of log RMSE against log spp, with an interval over seeds.
    RmseSlope,
    /// The difference of two means over seeds, in standard errors.
    Z { column: String, over: Conditions },
    /// Spearman's rank correlation of two columns, each averaged within groups.
    RankCorrelation { x: String, y: String, by: String },
    /// The largest number of different checksums of one image.
    Checksum,
    /// A simulated schedule on many cores.
    Forecast { strategy: String, cores: usize, column: ForecastColumn },
}

/// A column of a forecast.
#[derive(Debug, Clone, Copy)]
pub(super) enum ForecastColumn {
    Speedup,
    Efficiency,
    SerialFraction,
}

/// A column of the price list.
#[derive(Debug, Clone, Copy)]
pub(super) enum GuardColumn {
    ErrorWith,
    ErrorWithout,
    TimeRatio,
}

/// The names of all statistics, as claims write them.
const NAMES: [&str; 13] = [
    "value",
    "share",
    "count",
    "paired-ratio",
    "speedup",
    "exponent",
    "rmse-slope",
    "z",
    "rank-correlation",
    "checksum",
    "forecast",
    "case",
    "guard",
];

impl Statistic {
    /// Builds the statistic of that name from the claim's fields. Refuses a claim with fields that the statistic does
    /// not use.
    pub(super) fn taken_from(claim: &mut Claim, name: &str) -> Result<Self> {
        let needs = Needs { name, id: claim.id };
        let statistic = match name {
            "case" => Self::Case { ids: some_cases(needs.field("ids", claim.ids.take())?)? },
            "guard" => Self::Guard {
                guard: needs.field("guard", claim.guard.take())?,
                column: needs.one_of(claim.column.take(), &GUARD_COLUMNS)?,
            },
            _ => {
                let kind = Kind::taken_from(claim, name, &needs)?;
                let experiment = needs.field("experiment", claim.experiment.take())?;
                let rows = claim.rows.take().unwrap_or_default();
                rows.check("rows")?;
                Self::OfRows { experiment, rows, kind }
            }
        };
        match claim.unused_field() {
            None => Ok(statistic),
            Some(field) => {
                Err(InputError::new("statistic", name, format!("has no use for the claim's field `{field}`")).into())
            }
        }
    }
}

impl Kind {
    fn taken_from(claim: &mut Claim, name: &str, needs: &Needs<'_>) -> Result<Self> {
        Ok(match name {
            "value" => Self::Value {
                column: needs.column("column", claim.column.take())?,
                per: claim.per.take().map(|per| needs.column("per", Some(per))).transpose()?,
            },
            "share" => Self::Share {
                column: needs.column("column", claim.column.take())?,
                of: needs.column("of", claim.of.take())?,
            },
            "count" => Self::Count { column: needs.column("column", claim.column.take())? },
            "paired-ratio" => Self::PairedRatio {
                column: needs.column("column", claim.column.take())?,
                over: needs.conditions(claim.over.take())?,
            },
            "speedup" => Self::Speedup { over: needs.conditions(claim.over.take())? },
            "exponent" => {
                Self::Exponent { x: needs.column("x", claim.x.take())?, y: needs.column("y", claim.y.take())? }
            }
            "rmse-slope" => Self::RmseSlope,
            "z" => Self::Z {
                column: needs.column("column", claim.column.take())?,
                over: needs.conditions(claim.over.take())?,
            },
            "rank-correlation" => Self::RankCorrelation {
                x: needs.column("x", claim.x.take())?,
                y: needs.column("y", claim.y.take())?,
                by: needs.column("by", claim.by.take())?,
            },
            "checksum" => Self::Checksum,
            "forecast" => Self::Forecast {
                strategy: needs.field("strategy", claim.strategy.take())?,
                cores: needs.field("cores", claim.cores.take())?,
                column: needs.one_of(claim.column.take(), &FORECAST_COLUMNS)?,
            },
            _ => return Err(InputError::new("statistic", name, "is not a statistic").allowed(NAMES.join(", ")).into()),
        })
    }
}

const FORECAST_COLUMNS: [(&str, ForecastColumn); 3] = [
    ("speedup", ForecastColumn::Speedup),
    ("efficiency", ForecastColumn::Efficiency),
    ("serial-fraction", ForecastColumn::SerialFraction),
];

const GUARD_COLUMNS: [(&str, GuardColumn); 3] = [
    ("error_with", GuardColumn::ErrorWith),
    ("error_without", GuardColumn::ErrorWithout),
    ("time_ratio", GuardColumn::TimeRatio),
];

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
            Self::Case { ids } => write!(f, "failed among the hard cases {}", ids.join(", ")),
            Self::Guard { guard, column } => write!(f, "{} of the guard \"{guard}\"", column.name()),
            Self::OfRows { experiment, rows, kind } if rows.is_empty() => write!(f, "{kind}; all rows of {experiment}"),
            Self::OfRows { experiment, rows, kind } => write!(f, "{kind}; rows of {experiment} where {rows}"),
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value { column, per: None } => write!(f, "median {column}"),
            Self::Value { column, per: Some(per) } => write!(f, "median {column} / {per}"),
            Self::Share { column, of } => write!(f, "mean {column} / {of}"),
            Self::Count { column } => write!(f, "sum of {column}"),
            Self::PairedRatio { column, over } => write!(f, "median ratio of {column} to that of rows where {over}"),
            Self::Speedup { over } => write!(f, "median speedup against rows where {over}"),
            Self::Exponent { x, y } => write!(f, "exponent of {y} against {x}"),
            Self::RmseSlope => f.write_str("exponent of rmse against spp"),
            Self::Z { column, over } => write!(f, "z of mean {column} against rows where {over}"),
            Self::RankCorrelation { x, y, by } => write!(f, "rank correlation of {y} with {x} by {by}"),
            Self::Checksum => f.write_str("largest number of checksums of one image"),
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

/// The name of a statistic and its claim, to take the required fields.
struct Needs<'a> {
    name: &'a str,
    id: u32,
}

impl Needs<'_> {
    fn field<T>(&self, field: &str, value: Option<T>) -> Result<T> {
        value.ok_or_else(|| {
            InputError::new("statistic", self.name, format!("needs the field `{field}`, which claim {} lacks", self.id))
                .into()
        })
    }

    fn column(&self, field: &str, value: Option<String>) -> Result<String> {
        let column = self.field(field, value)?;
        check_column(field, &column)?;
        Ok(column)
    }

    fn conditions(&self, value: Option<Conditions>) -> Result<Conditions> {
        let conditions = self.field("over", value)?;
        conditions.check("over")?;
        Ok(conditions)
    }

    fn one_of<T: Copy>(&self, value: Option<String>, table: &[(&str, T)]) -> Result<T> {
        let name = self.field("column", value)?;
        let found = table.iter().find(|(known, _)| *known == name).map(|(_, value)| *value);
        found.ok_or_else(|| {
            let names: Vec<&str> = table.iter().map(|(name, _)| *name).collect();
            InputError::new("column", &name, format!("is not a column of a {}", self.name))
                .allowed(names.join(", "))
                .into()
        })
    }
}

fn some_cases(ids: Vec<String>) -> Result<Vec<String>> {
    if ids.is_empty() {
        return Err(InputError::new("ids", "", "names no hard case").allowed("names of `pathmark selftest`").into());
    }
    Ok(ids)
}
