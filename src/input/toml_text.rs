//! TOML files: size limits before reading, and errors that name file, line, column, field and value.

use crate::error::{Error, InputError, Result};
use serde::Deserializer;
use serde::de::{DeserializeOwned, DeserializeSeed, IgnoredAny, MapAccess, Visitor};
use std::fmt;
use std::io::Read;
use std::marker::PhantomData;
use std::ops::Range;
use std::path::Path;

/// No scene or experiment comes near this; a device file or a mistaken path does. Once parsed, a definition takes 70 times its length of
/// memory: more objects than fit here belong in a mesh or a generator.
const LARGEST_DEFINITION: u64 = 3 << 20;

/// The text of a definition.
pub(crate) fn read_text(path: &Path) -> Result<String> {
    read_text_up_to(path, LARGEST_DEFINITION)
}

/// The text of a user's file of so many bytes at most.
pub(crate) fn read_text_up_to(path: &Path, most: u64) -> Result<String> {
    let name = path.display().to_string();
    let file = std::fs::File::open(path).map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => InputError::new("file", &name, "there is no such file").into(),
        _ => Error::system("reading", path, e),
    })?;
    if file.metadata().is_ok_and(|data| data.is_dir()) {
        return Err(InputError::new("file", name, "is a directory").into());
    }
    let mut bytes = Vec::new();
    file.take(most + 1).read_to_end(&mut bytes).map_err(|e| Error::system("reading", path, e))?;
    if bytes.len() as u64 > most {
        let allowed = format!("up to {} MiB", most >> 20);
        return Err(InputError::new("file", name, "is larger than such a file can be").allowed(allowed).into());
    }
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        InputError::new("file", name, format!("is not UTF-8 text at byte {at}")).into()
    })
}

/// Reads a definition; `file` is the name to show.
pub(crate) fn parse<T: DeserializeOwned>(text: &str, file: &str) -> Result<T> {
    toml::from_str(text).map_err(|e| located(text, file, e.message(), e.span()).into())
}

/// Reads the table at the end of a path of keys, and nothing else of a definition; `None` if it has no such table.
pub(crate) fn parse_within<T: DeserializeOwned>(text: &str, file: &str, path: &[&str]) -> Result<Option<T>> {
    let found =
        toml::Deserializer::parse(text).and_then(|definition| Within(path, PhantomData).deserialize(definition));
    found.map_err(|e| located(text, file, e.message(), e.span()).into())
}

/// What stands at the end of a path of keys.
struct Within<'a, T>(&'a [&'a str], PhantomData<T>);

impl<'de, T: DeserializeOwned> DeserializeSeed<'de> for Within<'_, T> {
    type Value = Option<T>;

    fn deserialize<D: Deserializer<'de>>(self, table: D) -> std::result::Result<Self::Value, D::Error> {
        if self.0.is_empty() { T::deserialize(table).map(Some) } else { table.deserialize_map(self) }
    }
}

impl<'de, T: DeserializeOwned> Visitor<'de> for Within<'_, T> {
    type Value = Option<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut table: A) -> std::result::Result<Self::Value, A::Error> {
        let mut found = None;
        while let Some(key) = table.next_key::<String>()? {
            if key == self.0[0] {
                found = table.next_value_seed(Within(&self.0[1..], PhantomData))?;
            } else {
                table.next_value::<IgnoredAny>()?;
            }
        }
        Ok(found)
    }
}

fn located(text: &str, file: &str, message: &str, span: Option<Range<usize>>) -> InputError {
    let message = message.trim().replace('\n', "; ");
    let Some(span) = span else {
        return InputError::new("definition", "", message).in_file(file, None);
    };
    let (field, value) = field_and_value(text, &span);
    InputError::new(field, value, message).in_file(file, Some(line_and_column(text, span.start)))
}

/// Counted from 1, columns in characters.
fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = &text[..offset.min(text.len())];
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    (before.matches('\n').count() + 1, before[start..].chars().count() + 1)
}

/// The key that owns the span, and the span's own text as the value. The parser tells neither, but the text does: the key stands
/// before the nearest `=`, unless the span is itself a key (an unknown field) or a whole table.
fn field_and_value(text: &str, span: &Range<usize>) -> (String, String) {
    let is_key = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | '"');
    let spanned = text.get(span.clone()).unwrap_or("").trim();
    let after = text.get(span.end..).unwrap_or("").trim_start_matches([' ', '\t']);
    if !spanned.is_empty() && spanned.chars().all(is_key) && after.starts_with('=') {
        return (spanned.to_string(), String::new());
    }
    let before = text.get(..span.start).unwrap_or("");
    let owner = before.rfind('=').map(|at| before[..at].trim_end()).unwrap_or_default();
    let start = owner.char_indices().rev().find(|(_, c)| !is_key(*c)).map_or(0, |(at, c)| at + c.len_utf8());
    let field = owner[start..].to_string();
    let value: String = spanned.lines().next().unwrap_or("").chars().take(80).collect();
    if field.is_empty() { ("definition".to_string(), value) } else { (field, value) }
}

/// [`locate`] within the table of that name, as far as the next table.
pub(crate) fn locate_in(table: &str, text: &str, key: &str, value: &str) -> Option<(usize, usize)> {
    let head = format!("[{table}]");
    let is_line = |at: &usize| text[..*at].is_empty() || text[..*at].ends_with('\n');
    let start = text.match_indices(&head).map(|(at, _)| at).find(is_line)?;
    let end = text[start..].find("\n[").map_or(text.len(), |at| start + at + 1);
    let (line, column) = locate(&text[start..end], key, value)?;
    Some((line + text[..start].matches('\n').count(), column))
}

/// Line and column of a value that was found wrong after parsing: its first appearance behind the key.
pub(crate) fn locate(text: &str, key: &str, value: &str) -> Option<(usize, usize)> {
    let at_key = text.match_indices(key).map(|(at, _)| at).find(|at| {
        let starts_line = text[..*at].rsplit('\n').next().is_some_and(|before| before.trim().is_empty());
        starts_line && text[*at + key.len()..].trim_start().starts_with('=')
    })?;
    let at_value = text[at_key + key.len()..].find(value).filter(|_| !value.is_empty());
    Some(line_and_column(text, at_value.map_or(at_key, |at| at_key + key.len() + at)))
}
