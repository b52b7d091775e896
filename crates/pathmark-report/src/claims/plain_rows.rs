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
//! Two more columns are read if the file has them, with the meaning that they have in `records.csv`: `seed`, a whole
//! number, and `started_utc`, a time such as 2026-01-31T12:00:00Z. Both may be empty. Other columns are ignored.

use super::condition::Columns;
use crate::error::{Error, InputError, Result};
use crate::measure::{Record, ScheduleKey};
use crate::rows::Row;
use crate::schedule::Schedule;
use crate::time::{FORM, is_time};
use crate::words;
use csv::StringRecord;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Field, value, problem, and the allowed values.
struct Wrong(String, String, &'static str, &'static str);

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
        words::costs(self.seconds, self.bytes, self.machine.as_deref().unwrap_or_default())
    }

    pub(super) fn path(&self, folder: &Path) -> PathBuf {
        folder.join(&self.file)
    }

    /// The rows with their columns; `None` if the folder has no such file.
    pub(super) fn read(&self, folder: &Path) -> Result<Option<(Vec<Row>, Vec<Columns>)>> {
        let path = self.path(folder);
        let Some(file) = opened(&path)? else { return Ok(None) };
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
            let (record, columns) = self.row(&heads, &row).map_err(|Wrong(field, value, problem, allowed)| {
                refused(&field, &value, problem, line).allowed(allowed)
            })?;
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
        let wrong =
            |name: &str, problem, allowed| Wrong(name.to_string(), field(name).trim().to_string(), problem, allowed);
        let whole = |name: &str| {
            let number = field(name).trim().parse::<u32>();
            number.map_err(|_| wrong(name, "is not a whole number in this range", "0 to 4294967295"))
        };
        let seed = Some(field(SEED).trim()).filter(|text| !text.is_empty()).map(str::parse::<u64>).transpose();
        let seed = seed.map_err(|_| wrong(SEED, "is not a whole number in this range", "0 to 18446744073709551615"))?;
        let started = field(STARTED).trim();
        if !started.is_empty() && !is_time(started) {
            return Err(wrong(STARTED, "is not a time", FORM));
        }
        let mut columns = Columns::new();
        for name in &self.settings {
            columns.insert(name.clone(), Value::from(field(name)));
        }
        for name in &self.values {
            let text = field(name).trim();
            let value = match text.parse::<f64>() {
                _ if text.is_empty() => Value::Null,
                Ok(value) if value.is_finite() => Value::from(value),
                _ => return Err(wrong(name, "is not a finite number", "such as 0.5 or 1e-6, or nothing")),
            };
            columns.insert(name.clone(), value);
        }
        let in_pairs = self.pair.as_deref().unwrap_or(PAIR);
        let repetition = whole(&self.repetition)?;
        let pair = if field(in_pairs).trim().is_empty() { None } else { Some(whole(in_pairs)?) };
        columns.insert(self.repetition.clone(), Value::from(repetition));
        columns.insert(in_pairs.to_string(), Value::from(pair));
        columns.insert(SEED.to_string(), Value::from(seed));
        columns.insert(STARTED.to_string(), Value::from(started));
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
            seed: seed.unwrap_or(0),
            started_utc: started.to_string(),
            ..Record::default()
        };
        Ok((record, columns))
    }
}

/// Opens a user's file of rows; `None` if there is none.
fn opened(path: &Path) -> Result<Option<File>> {
    let refused = |problem: &str| {
        let error = InputError::new("file", path.display().to_string(), problem);
        Err(error.allowed("the path of a CSV file within the folder of rows").into())
    };
    let system = |e| Error::system("reading", path, e);
    match path.symlink_metadata() {
        Err(e) if matches!(e.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => return Ok(None),
        Err(e) if matches!(e.kind(), ErrorKind::InvalidInput | ErrorKind::InvalidFilename) => {
            return refused("cannot be the name of a file");
        }
        Err(e) => return Err(system(e)),
        Ok(_) => {}
    }
    match path.metadata() {
        Err(e) if e.kind() == ErrorKind::NotFound => refused("is a link to a file that is not there"),
        Err(e) => Err(system(e)),
        Ok(found) if found.is_dir() => refused("is a folder"),
        Ok(found) if !found.is_file() => refused("is not a regular file"),
        Ok(_) => File::open(path).map(Some).map_err(system),
    }
}
