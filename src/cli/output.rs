//! Output of results: into a folder, or to standard output, which a user may close at any time:
//! `pathmark list | head -1` is no failure.

use crate::error::{Error, Result};
use crate::files::create_folder;
use crate::lock::{Lock, Sharing};
use serde::Serialize;
use serde_json::Value;
use std::borrow::Cow;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Creates a folder of results if it is missing, and locks it against other processes as `sharing` says.
pub(super) fn lock_folder(out: &Path, sharing: Sharing) -> Result<Lock> {
    create_folder("out", out)?;
    Lock::of_folder(out, "out", sharing)
}

/// A count with its noun: `1 worker`, `2 workers`.
pub(super) fn counted(count: usize, thing: &str) -> String {
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
}

/// Whether a terminal would obey a character instead of showing it: control characters, ends of lines of any script, and
/// the marks that reverse the direction of what follows.
fn is_command(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A name as it can be shown in a line of text: characters that a terminal would obey are escaped, as in `\u{1b}`.
pub(super) fn printable(name: &str) -> Cow<'_, str> {
    escaped(name, is_command, |character| character.escape_default().to_string())
}

fn escaped(text: &str, is_bad: fn(char) -> bool, escape: fn(char) -> String) -> Cow<'_, str> {
    if !text.contains(is_bad) {
        return text.into();
    }
    let one = |character| if is_bad(character) { escape(character) } else { String::from(character) };
    text.chars().map(one).collect::<String>().into()
}

/// Lines of text in which characters that a terminal would obey are escaped, apart from tabs and the ends of the lines.
pub(super) fn printable_lines(text: &str) -> Cow<'_, str> {
    let is_bad = |character| is_command(character) && !matches!(character, '\n' | '\t');
    escaped(text, is_bad, |character| character.escape_default().to_string())
}

/// Prints a text and a line end.
pub(super) fn print(text: &str) -> Result<()> {
    write(&printable_lines(text))
}

fn write(text: &str) -> Result<()> {
    match writeln!(std::io::stdout().lock(), "{text}") {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::system("writing", "standard output", e)),
        _ => Ok(()),
    }
}

/// Prints a value as one line of JSON. Absent values are `null`; NaN and infinities, for which JSON has no numbers, are
/// the texts "NaN", "inf" and "-inf".
pub(super) fn print_json(value: &impl Serialize) -> Result<()> {
    let failed = |e: serde_json::Error| Error::system("writing", "standard output", e.into());
    let mut json = serde_json::to_value(value).map_err(failed)?;
    // TOML keeps NaN and infinities, which JSON turns into null.
    let named = toml::Value::try_from(value).is_ok_and(|exact| name_odd_numbers(&mut json, &exact));
    // If nothing has to be replaced, fields keep their order.
    let line = if named { json.to_string() } else { serde_json::to_string(value).map_err(failed)? };
    // JSON itself escapes only the first 32 characters. All that are left stand in texts.
    write(&escaped(&line, is_command, |character| format!("\\u{:04x}", u32::from(character))))
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
pub(super) fn number(value: f64) -> Value {
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

    /// Escapes of colours, of the second control block and of reversed text, a line end, and text that stays.
    #[test]
    fn a_terminal_shows_names_and_obeys_none() {
        assert_eq!(printable("a\u{1b}[2Jb\u{9b}c\nd\u{202e}e"), "a\\u{1b}[2Jb\\u{9b}c\\nd\\u{202e}e");
        assert_eq!(printable_lines("a\r\n\tb\u{7f}"), "a\\r\n\tb\\u{7f}");
        assert!(matches!(printable("Größe 1 °C, 木 \\"), Cow::Borrowed("Größe 1 °C, 木 \\")));
    }
}
