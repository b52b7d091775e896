//! `records.csv`: written row by row, flushed to the disk after each, so that a killed sweep loses at most the row it was writing.

use super::packed_rows;
use crate::atomic_file;
use crate::disk::{OnDisk, Step, step};
use crate::error::{Error, InputError, Result};
use crate::lock::{self, Sharing};
use crate::measure::{COLUMNS, Column, Record, SCHEMA};
use csv::StringRecord;
use std::collections::HashSet;
use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

pub(super) const RECORDS: &str = "records.csv";

/// Versions of the columns that can be read. The older ones only lack columns that may be empty.
const READABLE: [u32; 8] = [7, 8, 9, 10, 11, 12, 13, SCHEMA];

/// An open file of records, locked against a second sweep.
pub struct RecordsFile {
    path: PathBuf,
    file: File,
    /// Its expected length: no other process should write to it.
    length: u64,
}

/// Reads every row; a row that cannot be read is an error that names its line.
pub fn read_records(path: &Path) -> Result<Vec<Record>> {
    // A pipe without a writer and a device without an end would be read for ever.
    if std::fs::metadata(path).is_ok_and(|found| !found.is_file()) {
        return Err(InputError::new("records", path.display().to_string(), "is not a regular file").into());
    }
    let bytes = packed_rows::read(path)?;
    let complete = complete_part(&bytes, path)?;
    if complete.len() < bytes.len() {
        let line = complete.matches('\n').count() + 1;
        let problem =
            "the last row is only half written; the command in machine.toml with --resume drops it and runs it again";
        let row: String = String::from_utf8_lossy(&bytes[complete.len()..]).chars().take(40).collect();
        return Err(InputError::new("row", row, problem).in_file(path.display().to_string(), Some((line, 1))).into());
    }
    parse(complete, path)
}

/// The part of a file up to its last finished row. The rest, left by a crash, need not even be text.
fn complete_part<'a>(bytes: &'a [u8], path: &Path) -> Result<&'a str> {
    let end = end_of_rows(bytes);
    let refuse = |before: usize, problem: &str| {
        let line = bytes[..before].split(|byte| *byte == b'\n').count();
        InputError::new("row", "", problem).in_file(path.display().to_string(), Some((line, 1))).into()
    };
    // A crash truncates one row. Whole rows after an unclosed quote would be dropped with it.
    let fields = |line: &[u8]| line.split(|byte| *byte == b',').count();
    let head = bytes.split(|byte| *byte == b'\n').next().map_or(0, fields);
    if bytes[end..].split(|byte| *byte == b'\n').skip(1).any(|line| head > 1 && fields(line) >= head) {
        return Err(refuse(end, "has a quote that is not closed before the next row"));
    }
    std::str::from_utf8(&bytes[..end]).map_err(|e| refuse(e.valid_up_to(), "is not UTF-8 text"))
}

/// The end of the last finished row. A line end between quotes is part of a field.
fn end_of_rows(bytes: &[u8]) -> usize {
    let (mut quoted, mut end, mut before) = (false, 0, b'\n');
    for (at, byte) in bytes.iter().enumerate() {
        match byte {
            // A quote opens a field at its beginning; after another quote, which it doubles, it continues the field.
            b'"' => quoted = !quoted && matches!(before, b'\n' | b',' | b'"'),
            b'\n' if !quoted => end = at + 1,
            _ => {}
        }
        before = *byte;
    }
    end
}

/// Whether a file has the columns of the rows to add in the same order. Refuses a file with other columns.
fn are_in_order(text: &str, path: &Path) -> Result<bool> {
    let head = csv::ReaderBuilder::new().from_reader(text.as_bytes()).headers().cloned().unwrap_or_default();
    let own: Vec<&str> = COLUMNS.iter().map(|column| column.name).collect();
    if head.is_empty() || head.iter().eq(own.iter().copied()) {
        return Ok(true);
    }
    let lacking: Vec<&str> = own.iter().copied().filter(|name| !head.iter().any(|other| other == *name)).collect();
    let more: Vec<&str> = head.iter().filter(|name| !own.contains(name)).collect();
    let sides = [("lacks", lacking), ("has", more)].map(|(side, names)| (side, names.join(", ")));
    let differences = sides.into_iter().filter(|(_, names)| !names.is_empty());
    let differences: Vec<String> = differences.map(|(side, names)| format!("it {side} {names}")).collect();
    if differences.is_empty() {
        return Ok(false);
    }
    let problem = format!(
        "the file was written with other columns, so this version of the program cannot add rows to it: {}",
        differences.join("; ")
    );
    let error = InputError::new("columns", "", problem);
    let error = error.allowed("another --out, or the version of the program that wrote the file");
    Err(error.in_file(path.display().to_string(), Some((1, 1))).into())
}

fn parse(text: &str, path: &Path) -> Result<Vec<Record>> {
    let file = path.display().to_string();
    let mut records = Vec::new();
    let mut seen = HashSet::new();
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let columns: StringRecord =
        reader.headers().map(|names| names.iter().map(Column::new_name).collect()).unwrap_or_default();
    let schema = columns.iter().position(|column| column == "schema");
    let times = times(&columns);
    for row in reader.records() {
        let broken = |column: &str, e: &csv::Error| {
            let line = e.position().map(|position| (position.line() as usize, 1));
            Error::from(InputError::new(column, "", format!("cannot be read: {e}")).in_file(&file, line))
        };
        let row = row.map_err(|e| broken("row", &e))?;
        let line = row.position().map(|position| (position.line() as usize, 1));
        // The schema is checked first, because other versions have other columns.
        let found = schema.and_then(|at| row.get(at)).unwrap_or_default();
        if !READABLE.iter().any(|readable| found == readable.to_string()) {
            let problem = "was written by another version of the program";
            return Err(InputError::new("schema", found, problem)
                .allowed(READABLE.map(|readable| readable.to_string()).join(", "))
                .in_file(&file, line)
                .into());
        }
        let record: Record = row.deserialize(Some(&columns)).map_err(|e| {
            let column = match e.kind() {
                csv::ErrorKind::Deserialize { err, .. } => err.field().and_then(|at| columns.get(at as usize)),
                _ => None,
            };
            broken(column.unwrap_or("row"), &e)
        })?;
        if let Some(error) = impossible_time(&record, &row, &times) {
            return Err(error.in_file(&file, line).into());
        }
        if !seen.insert((record.cell.clone(), record.repetition, record.pair)) {
            let pair = record.pair.map(|pair| format!(", pair {pair}")).unwrap_or_default();
            let problem = format!("occurs twice for repetition {}{pair}", record.repetition);
            return Err(InputError::new("cell", &record.cell, problem).in_file(&file, line).into());
        }
        records.push(record);
    }
    Ok(records)
}

/// Columns of seconds that are differences of others, so that rounding may leave them below 0.
const DIFFERENCES: [&str; 3] = ["idle_between_jobs_s", "idle_tail_s", "other_cpu_s"];

fn times(columns: &StringRecord) -> Vec<(usize, &'static str)> {
    let in_seconds = |name: &str| COLUMNS.iter().find(|own| own.name == name && own.unit() == Some("seconds"));
    let found = columns.iter().enumerate().filter_map(|(place, name)| Some((place, in_seconds(name)?.name)));
    found.collect()
}

/// The first time of a row that no clock shows. If it counted as absent, a comparison would miss its cell.
fn impossible_time(record: &Record, row: &StringRecord, times: &[(usize, &'static str)]) -> Option<InputError> {
    let is_possible = |name: &str, seconds: f64| match name {
        _ if !seconds.is_finite() => false,
        "makespan_s" => seconds > 0.0,
        name => seconds >= 0.0 || DIFFERENCES.contains(&name),
    };
    if !record.error.is_empty() {
        return None;
    }
    let values = times.iter().filter_map(|(place, name)| Some((*name, row.get(*place)?)));
    // Values that are no numbers were refused before.
    let mut values = values.filter_map(|(name, value)| Some((name, value, value.parse().ok()?)));
    let (name, value, _) = values.find(|(name, _, seconds)| !is_possible(name, *seconds))?;
    let allowed = if name == "makespan_s" { "a finite number above 0" } else { "a finite number from 0" };
    Some(InputError::new(name, value, "is not a possible time").allowed(allowed))
}

impl RecordsFile {
    /// Creates a file; refuses to replace an existing one.
    pub fn create(path: &Path) -> Result<Self> {
        let create = || step(Step::Create).and_then(|()| OpenOptions::new().write(true).create_new(true).open(path));
        let file = create().map_err(|e| match e.kind() {
            std::io::ErrorKind::AlreadyExists => {
                let problem = "already exists: `--resume` continues it, another `--out` starts a new sweep";
                InputError::new("records", path.display().to_string(), problem).into()
            }
            _ => Error::system("creating", path, e),
        })?;
        Self::locked(path, file)
    }

    /// Opens an existing file and returns its rows, except a half-written last row and failed rows, which are run
    /// again. Columns in another order, as some versions of the program wrote them, are put in order.
    pub fn resume(path: &Path) -> Result<(Self, Vec<Record>)> {
        let open = || {
            let file = OpenOptions::new().read(true).write(true).open(path);
            Self::locked(path, file.map_err(|e| Error::system("opening", path, e))?)
        };
        let locked = open()?;
        let bytes = std::fs::read(path).map_err(|e| Error::system("reading", path, e))?;
        let complete = complete_part(&bytes, path)?;
        let mut records = parse(complete, path)?;
        let are_in_order = are_in_order(complete, path)?;
        let rows = records.len();
        // A program or device that was missing may be there by now.
        records.retain(|record| record.error.is_empty() && !record.is_left_out());
        if are_in_order && rows == records.len() && complete.len() == bytes.len() {
            return Ok((locked, records));
        }
        // The new file replaces the old one in one step, so a kill here loses nothing.
        let mut bytes = Vec::new();
        for (index, record) in records.iter().enumerate() {
            bytes.extend(row_bytes(record, index == 0).map_err(|e| Error::system("writing", path, e))?);
        }
        atomic_file::write(path, |out| out.write_all(&bytes))?;
        Ok((open()?, records))
    }

    pub fn has_rows(path: &Path) -> Result<bool> {
        let bytes = std::fs::read(path).map_err(|e| Error::system("reading", path, e))?;
        let complete = complete_part(&bytes, path)?;
        Ok(csv::Reader::from_reader(complete.as_bytes()).records().next().is_some())
    }

    pub fn check_idle(path: &Path) -> Result<()> {
        let file = File::open(path).map_err(|e| Error::system("opening", path, e))?;
        Self::locked(path, file).map(|_| ())
    }

    fn locked(path: &Path, file: File) -> Result<Self> {
        let system = |e| Error::system("locking", path, e);
        if lock::try_lock(&file, path, Sharing::Alone).map_err(system)? {
            let length = file.metadata().map_err(system)?.len();
            return Ok(Self { path: path.to_path_buf(), file, length });
        }
        Err(InputError::new("records", path.display().to_string(), "is being written by another sweep").into())
    }

    /// Refuses to continue if a program that ignores locks has replaced, removed or changed the file: rows would go to
    /// a file that nobody reads, or after rows that no longer exist.
    pub fn check_own(&self) -> Result<()> {
        let length = self.file.metadata().map_err(|e| Error::system("writing", &self.path, e))?.len();
        let problem = if !lock::leads_to(&self.path, &self.file) {
            "was replaced or removed while the sweep wrote to it".to_string()
        } else if length != self.length {
            format!("was changed while the sweep wrote to it: {length} bytes instead of {}", self.length)
        } else {
            return Ok(());
        };
        Err(InputError::new("records", self.path.display().to_string(), problem).into())
    }

    /// Appends a row and waits until it is on the disk. On failure, the file keeps its earlier length, if the disk
    /// allows it.
    pub fn append(&mut self, record: &Record) -> Result<()> {
        self.append_all(std::slice::from_ref(record))
    }

    /// The same for several rows: all of them, or none.
    pub fn append_all(&mut self, records: &[Record]) -> Result<()> {
        self.check_own()?;
        let each = records.iter().enumerate().map(|(at, record)| row_bytes(record, self.length == 0 && at == 0));
        let outcome = each.collect::<std::io::Result<Vec<_>>>().map(|rows| rows.concat()).and_then(|bytes| {
            self.file.seek(SeekFrom::Start(self.length))?;
            OnDisk(&self.file).write_all(&bytes)?;
            step(Step::Sync)?;
            self.file.sync_data()?;
            Ok(bytes.len() as u64)
        });
        let written = outcome.map_err(|e| {
            // The next `--resume` would drop half a row, but `report` would have to refuse it.
            self.file.set_len(self.length).ok();
            Error::system("writing", &self.path, e)
        })?;
        self.length += written;
        Ok(())
    }
}

fn row_bytes(record: &Record, header: bool) -> std::io::Result<Vec<u8>> {
    let mut writer = csv::WriterBuilder::new().has_headers(header).from_writer(Vec::new());
    writer.serialize(record)?;
    writer.into_inner().map_err(csv::IntoInnerError::into_error)
}
