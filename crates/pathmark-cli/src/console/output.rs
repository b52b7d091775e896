//! Output of results: into a folder, or to standard output, which a user may close at any time:
//! `pathmark list | head -1` is no failure.

use crate::error::{Error, Result, printable};
use crate::files::create_folder;
use crate::lock::{Lock, Sharing};
use serde::Serialize;
use serde_json::Value;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Creates a folder of results if it is missing, and locks it against other processes as `sharing` says.
pub(crate) fn lock_folder(out: &Path, sharing: Sharing) -> Result<Lock> {
    create_folder("out", out)?;
    Lock::of_folder(out, "out", sharing)
}

/// A text of one or more lines for a terminal, with the control characters of names in it escaped.
pub(super) fn safe(text: &str) -> String {
    text.split('\n').map(printable).collect::<Vec<_>>().join("\n")
}

/// Prints a text and a line end.
pub(crate) fn print(text: &str) -> Result<()> {
    print_verbatim(&safe(text))
}

/// Prints a text of the program's own, such as a script, and a line end.
pub(crate) fn print_verbatim(text: &str) -> Result<()> {
    match writeln!(std::io::stdout().lock(), "{text}") {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::system("writing", "standard output", e)),
        _ => Ok(()),
    }
}

/// Columns under their heads. The first is aligned to the left, the others to the right if `is_of_numbers`.
pub(crate) fn aligned(heads: Vec<String>, rows: impl IntoIterator<Item = Vec<String>>, is_of_numbers: bool) -> String {
    let lines: Vec<Vec<String>> = std::iter::once(heads).chain(rows).collect();
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..lines[0].len()).map(width).collect();
    let aligned = |line: &Vec<String>| {
        let cell = |(column, (text, width)): (usize, (&String, &usize))| {
            if is_of_numbers && column > 0 { format!("{text:>width$}") } else { format!("{text:width$}") }
        };
        line.iter().zip(&widths).enumerate().map(cell).collect::<Vec<_>>().join("  ").trim_end().to_string()
    };
    lines.iter().map(aligned).collect::<Vec<_>>().join("\n")
}

fn failed(error: serde_json::Error) -> Error {
    Error::system("writing", "standard output", error.into())
}

/// A value as [`print_json`] prints it, and whether it has texts instead of numbers.
fn exact_json(value: &impl Serialize) -> Result<(Value, bool)> {
    let mut json = serde_json::to_value(value).map_err(failed)?;
    // TOML keeps NaN and infinities, which JSON turns into null.
    let named = toml::Value::try_from(value).is_ok_and(|exact| name_odd_numbers(&mut json, &exact));
    Ok((json, named))
}

/// A value as a part of an object that [`print_json`] prints.
pub(crate) fn json_of(value: &impl Serialize) -> Result<Value> {
    Ok(exact_json(value)?.0)
}

/// Prints a value as one line of JSON. Absent values are `null`; NaN and infinities, for which JSON has no numbers, are
/// the texts "NaN", "inf" and "-inf".
pub(crate) fn print_json(value: &impl Serialize) -> Result<()> {
    let (json, named) = exact_json(value)?;
    // If nothing has to be replaced, fields keep their order.
    let line = if named { json.to_string() } else { serde_json::to_string(value).map_err(failed)? };
    // JSON itself escapes only the first 32 characters. All control characters that are left stand in texts.
    let escape = |c: char| if c.is_control() { format!("\\u{:04x}", u32::from(c)) } else { String::from(c) };
    print_verbatim(&line.chars().map(escape).collect::<String>())
}

/// Replaces nulls that were numbers by texts; returns whether there were any.
fn name_odd_numbers(json: &mut Value, exact: &toml::Value) -> bool {
    match (json, exact) {
        (json @ Value::Null, toml::Value::Float(found)) => {
            *json = number(*found);
            true
        }
        (Value::Array(values), toml::Value::Array(exact)) => {
            values.iter_mut().zip(exact).fold(false, |named, (json, exact)| name_odd_numbers(json, exact) | named)
        }
        (Value::Object(values), toml::Value::Table(exact)) => exact.iter().fold(false, |named, (field, exact)| {
            values.get_mut(field).is_some_and(|json| name_odd_numbers(json, exact)) | named
        }),
        _ => false,
    }
}

/// A number as [`print_json`] prints it, for JSON that is built by hand.
pub(crate) fn number(value: f64) -> Value {
    if value.is_finite() { Value::from(value) } else { Value::from(value.to_string()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize)]
    struct Row {
        name: &'static str,
        values: Vec<f64>,
        absent: Option<f64>,
        there: Option<f64>,
    }

    #[test]
    fn absent_nan_and_infinite_are_told_apart() {
        let rows = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.5].map(|value| Row {
            name: "a",
            values: vec![1.0, value],
            absent: None,
            there: Some(value),
        });
        let mut json = serde_json::to_value(&rows).unwrap();
        assert!(name_odd_numbers(&mut json, &toml::Value::try_from(&rows).unwrap()));
        let found: Vec<_> = json.as_array().unwrap().iter().map(|row| [&row["there"], &row["values"][1]]).collect();
        let expected = [Value::from("NaN"), Value::from("inf"), Value::from("-inf"), Value::from(0.5)];
        assert_eq!(found, expected.each_ref().map(|value| [value, value]));
        assert!(json.as_array().unwrap().iter().all(|row| row["absent"].is_null() && row["name"] == "a"));
        let mut fine = serde_json::to_value(&rows[3]).unwrap();
        assert!(!name_odd_numbers(&mut fine, &toml::Value::try_from(&rows[3]).unwrap()));
    }
}
