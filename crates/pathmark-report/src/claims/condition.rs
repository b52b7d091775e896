//! Conditions on rows: columns of `records.csv` and the values required in them.

use crate::measure::Record;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Deref;

/// A row by its columns, as `records.csv` writes them.
pub(super) type Columns = serde_json::Map<String, serde_json::Value>;

pub(super) fn columns(record: &Record) -> Columns {
    match serde_json::to_value(record) {
        Ok(serde_json::Value::Object(columns)) => columns,
        _ => Columns::new(),
    }
}

/// The value of a column, as text; empty if nothing was measured.
pub(super) fn text(row: &Columns, column: &str) -> String {
    match row.get(column) {
        None | Some(serde_json::Value::Null) => String::new(),
        Some(serde_json::Value::String(text)) => text.clone(),
        Some(other) => other.to_string(),
    }
}

/// The value of a column as a number. Settings of other programs are texts.
pub(super) fn number(row: &Columns, column: &str) -> Option<f64> {
    match row.get(column)? {
        serde_json::Value::String(text) => text.parse().ok().filter(|number: &f64| number.is_finite()),
        other => other.as_f64(),
    }
}

/// The columns of `records.csv`.
pub(super) fn known_columns() -> Vec<String> {
    columns(&Record::default()).keys().cloned().collect()
}

/// The name of a column, of `records.csv` or of another program's table; `Claim::resolve` checks that it is there.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(transparent)]
pub(super) struct Column(String);

impl Deref for Column {
    type Target = str;
    fn deref(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Conditions that all have to hold, by column.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(transparent)]
pub(super) struct Conditions(BTreeMap<Column, Wanted>);

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "neither a value nor a list of values")]
enum Wanted {
    One(Value),
    AnyOf(Vec<Value>),
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "neither a text, a number nor a boolean")]
enum Value {
    Whole(i64),
    Number(f64),
    Boolean(bool),
    Text(String),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole(number) => number.fmt(f),
            Self::Number(number) => number.fmt(f),
            Self::Boolean(is_true) => is_true.fmt(f),
            Self::Text(text) => text.fmt(f),
        }
    }
}

impl Value {
    /// Whether a row has this value or, for ">=2" and "<=4", keeps to this bound.
    fn admits(&self, row: &Columns, column: &str) -> bool {
        let wanted = self.to_string();
        let own = || number(row, column);
        let bound = |digits: &str| digits.trim().parse::<f64>().ok();
        if let Some(least) = wanted.strip_prefix(">=").and_then(bound) {
            return own().is_some_and(|own| own >= least);
        }
        if let Some(most) = wanted.strip_prefix("<=").and_then(bound) {
            return own().is_some_and(|own| own <= most);
        }
        wanted == text(row, column)
    }
}

impl Wanted {
    fn values(&self) -> &[Value] {
        match self {
            Self::One(value) => std::slice::from_ref(value),
            Self::AnyOf(values) => values,
        }
    }
}

impl Conditions {
    /// Whether a row meets all conditions.
    pub(super) fn admit(&self, row: &Columns) -> bool {
        self.0.iter().all(|(column, wanted)| wanted.values().iter().any(|value| value.admits(row, column)))
    }

    /// Whether every row meets the conditions.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The columns that the conditions name.
    pub(super) fn columns(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(|column| &**column)
    }

    /// The first value that none of these rows has, with its column.
    pub(super) fn absent(&self, rows: &[&Columns]) -> Option<(&str, String)> {
        self.0.iter().find_map(|(column, wanted)| {
            let is_absent = |value: &&Value| !rows.iter().any(|row| value.admits(row, column));
            Some((&**column, wanted.values().iter().find(is_absent)?.to_string()))
        })
    }

    /// The conditions that a row does not meet: column, its value, the required value.
    pub(super) fn differences(&self, row: &Columns) -> Vec<(String, String, String)> {
        let missed = |(column, wanted): (&Column, &Wanted)| {
            let is_met = wanted.values().iter().any(|value| value.admits(row, column));
            (!is_met).then(|| (column.to_string(), text(row, column), wanted.to_string()))
        };
        self.0.iter().filter_map(missed).collect()
    }
}

impl fmt::Display for Wanted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let values: Vec<String> = self.values().iter().map(ToString::to_string).collect();
        f.write_str(&values.join(" or "))
    }
}

/// Writes the conditions in words: "strategy = thread-per-row, spp = 8 or 20".
impl fmt::Display for Conditions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<String> = self.0.iter().map(|(column, wanted)| format!("{column} = {wanted}")).collect();
        f.write_str(&parts.join(", "))
    }
}
