//! Rows of another program: a CSV file whose columns a ledger names. Any harness can write it.
//!
//! ```toml
//! [[table]]
//! name = "sorts"                      # claims ask for it by `experiment = "sorts"`
//! file = "sorts.csv"                  # in each folder that is judged
//! settings = ["program", "n"]         # columns that say what ran: rows are paired by them
//! values = ["seconds"]                # columns of measured numbers; an empty field was not measured
//! repetition = "run"                  # the column of whole numbers that counts repetitions [default: repetition]
//! pair = "round"                      # the column that counts pairs within a repetition [default: pair, if it is there]
//! command = "sh measure.sh"           # measures the rows; for plans and appendices, like the next fields
//! seconds = 400                       # that it takes
//! bytes = 20000                       # that it writes
//! machine = "two cores of a Zen 5"    # on which it takes them
//! ```
//!
//! Two more columns are read if the file has them, with the meaning that they have in `records.csv`: `seed` and
//! `started_utc`. Other columns are ignored.

use super::condition::Columns;
use crate::error::{Error, InputError, Result};
use crate::measure::{Record, ScheduleKey};
use crate::rows::Row;
use crate::schedule::Schedule;
use csv::StringRecord;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Field, value and problem.
struct Wrong(String, String, &'static str);

/// A table of rows, as a ledger describes it.
#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlainRows {
    pub(super) name: String,
    pub file: String,
    pub(super) settings: Vec<String>,
    values: Vec<String>,
    #[serde(default = "repetition")]
    repetition: String,
    pair: Option<String>,
    /// The command that measures the rows. Nothing here runs it.
    pub command: Option<String>,
    /// Seconds that it takes, bytes that it writes, and the machine of these numbers, all as the ledger tells them.
    pub seconds: Option<f64>,
    pub bytes: Option<u64>,
    pub machine: Option<String>,
}

fn repetition() -> String {
    "repetition".to_string()
}

const PAIR: &str = "pair";
const SEED: &str = "seed";
const STARTED: &str = "started_utc";

impl PlainRows {
    /// Checks what can be checked without the file.
    pub(super) fn check(&self) -> Result<()> {
        for (field, value) in [("name", &self.name), ("file", &self.file)] {
            if value.is_empty() {
                return Err(InputError::new(field, value, "is empty").into());
            }
        }
        for (field, value) in [("command", &self.command), ("machine", &self.machine)] {
            if value.as_ref().is_some_and(|value| value.trim().is_empty() || value.contains(char::is_control)) {
                let problem = "is empty or contains a control character";
                return Err(InputError::new(field, value.as_deref().unwrap_or_default(), problem).into());
            }
        }
        if let Some(seconds) = self.seconds.filter(|seconds| !(seconds.is_finite() && *seconds >= 0.0)) {
            return Err(InputError::new("seconds", seconds.to_string(), "is no time").allowed("0 or more").into());
        }
        let mut seen = BTreeSet::new();
        for (field, column) in self.named() {
            if !seen.insert(column) {
                return Err(InputError::new(field, column, "is named twice among the columns of a table").into());
            }
        }
        Ok(())
    }

    fn named(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let settings = self.settings.iter().map(|column| ("settings", column.as_str()));
        let values = self.values.iter().map(|column| ("values", column.as_str()));
        let pair = self.pair.iter().map(|column| ("pair", column.as_str()));
        settings.chain(values).chain([("repetition", self.repetition.as_str())]).chain(pair)
    }

    /// The columns that claims may name.
    pub(super) fn columns(&self) -> impl Iterator<Item = &str> {
        self.named().map(|(_, column)| column).chain([SEED, STARTED])
    }

    /// The resources of a new measurement in words; empty if the ledger tells none.
    pub fn costs(&self) -> String {
        let seconds = self.seconds.map(|seconds| format!("{seconds:.0} s"));
        let bytes = self.bytes.map(|bytes| format!("{:.1} MB", bytes as f64 / 1e6));
        let machine = self.machine.as_ref().map(|machine| format!("on {machine}"));
        [seconds, bytes, machine].into_iter().flatten().collect::<Vec<String>>().join(", ")
    }

    pub(super) fn path(&self, folder: &Path) -> PathBuf {
        folder.join(&self.file)
    }

    /// The rows with their columns; `None` if the folder has no such file.
    pub(super) fn read(&self, folder: &Path) -> Result<Option<(Vec<Row>, Vec<Columns>)>> {
        let path = self.path(folder);
        if !path.is_file() {
            return Ok(None);
        }
        let file = std::fs::File::open(&path).map_err(|e| Error::system("reading", &path, e))?;
        let mut reader = csv::Reader::from_reader(file);
        let refused = |field: &str, value: &str, problem: &str, line: usize| {
            InputError::new(field, value, problem).in_file(path.display().to_string(), Some((line, 1)))
        };
        let unreadable = |e: &csv::Error| {
            let line = e.position().map_or(1, |position| position.line() as usize);
            refused("row", "", &format!("cannot be read: {e}"), line)
        };
        let heads = reader.headers().map_err(|e| unreadable(&e))?.clone();
        if let Some((_, lacking)) = self.named().find(|(_, column)| !heads.iter().any(|head| head == *column)) {
            let names: Vec<&str> = heads.iter().collect();
            return Err(refused("column", lacking, "is not in the file", 1).allowed(names.join(", ")).into());
        }
        let (mut rows, mut all, mut seen) = (Vec::new(), Vec::new(), BTreeSet::new());
        for row in reader.into_records() {
            let row = row.map_err(|e| unreadable(&e))?;
            let line = row.position().map_or(1, |position| position.line() as usize);
            let (record, columns) = self
                .row(&heads, &row)
                .map_err(|Wrong(field, value, problem)| refused(&field, &value, problem, line))?;
            if !seen.insert((record.cell.clone(), record.repetition, record.pair)) {
                let problem =
                    "occurs twice with one repetition; name the column that tells both rows apart in `settings`";
                return Err(refused("settings", &record.cell, problem, line).into());
            }
            let schedule = Schedule { name: String::new(), key: ScheduleKey::default() };
            rows.push(Row::new(record, None, schedule));
            all.push(columns);
        }
        Ok(Some((rows, all)))
    }

    /// A row as it is paired, and its columns.
    fn row(&self, heads: &StringRecord, row: &StringRecord) -> std::result::Result<(Record, Columns), Wrong> {
        let field =
            |name: &str| heads.iter().position(|head| head == name).and_then(|at| row.get(at)).unwrap_or_default();
        let whole = |name: &str| {
            let text = field(name).trim();
            text.parse::<u32>().map_err(|_| Wrong(name.to_string(), text.to_string(), "is not a whole number from 0"))
        };
        let optional = |name: &str| if field(name).is_empty() { Ok(None) } else { whole(name).map(Some) };
        let mut columns = Columns::new();
        for name in &self.settings {
            columns.insert(name.clone(), Value::from(field(name)));
        }
        for name in &self.values {
            let text = field(name).trim();
            let value = match text.parse::<f64>() {
                _ if text.is_empty() => Value::Null,
                Ok(value) if value.is_finite() => Value::from(value),
                _ => return Err(Wrong(name.clone(), text.to_string(), "is not a finite number")),
            };
            columns.insert(name.clone(), value);
        }
        let in_pairs = self.pair.as_deref().unwrap_or(PAIR);
        let (repetition, pair, seed) = (whole(&self.repetition)?, optional(in_pairs)?, optional(SEED)?);
        columns.insert(self.repetition.clone(), Value::from(repetition));
        for (name, value) in [(in_pairs, pair), (SEED, seed)] {
            columns.insert(name.to_string(), value.map_or(Value::Null, Value::from));
        }
        columns.insert(STARTED.to_string(), Value::from(field(STARTED)));
        let own = self.settings.iter().map(|name| format!("{name}={}", field(name)));
        let cell: Vec<String> = own.chain(seed.map(|seed| format!("seed={seed}"))).collect();
        let cell = cell.join("/");
        let record = Record {
            // Rows of two cells are of two images.
            scene_hash: cell.clone(),
            cell,
            scene: columns.get("scene").and_then(Value::as_str).unwrap_or_default().to_string(),
            repetition,
            pair,
            seed: u64::from(seed.unwrap_or(0)),
            started_utc: field(STARTED).to_string(),
            ..Record::default()
        };
        Ok((record, columns))
    }
}
