//! TOML text, and errors that name file, line, column, field and value.

use crate::error::{InputError, Result};
use serde::de::DeserializeOwned;
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, Visitor};
use std::ops::Range;
use std::{fmt, marker::PhantomData};

/// Parses a definition; `file` is its name in errors.
pub fn parse<T: DeserializeOwned>(text: &str, file: &str) -> Result<T> {
    toml::from_str(text).map_err(|e| located(text, file, e.message(), e.span()).into())
}

/// Parses only the table at the end of a path of keys; returns `None` if the definition has no such table.
pub fn parse_within<T: DeserializeOwned>(text: &str, file: &str, path: &[&str]) -> Result<Option<T>> {
    let found =
        toml::Deserializer::parse(text).and_then(|definition| Within(path, PhantomData).deserialize(definition));
    found.map_err(|e| located(text, file, e.message(), e.span()).into())
}

/// Deserialises only the value at the end of a path of keys.
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

/// Returns line and column of a byte offset, counted from 1, columns in characters.
pub fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = &text[..offset.min(text.len())];
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    (before.matches('\n').count() + 1, before[start..].chars().count() + 1)
}

/// Returns the key that owns the span, and the span's text as the value. The parser reports neither, so both are taken
/// from the text. The key stands before the nearest `=`, unless the span is itself a key (an unknown field) or a whole
/// table.
fn field_and_value(text: &str, span: &Range<usize>) -> (String, String) {
    let is_key = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | '"');
    let spanned = text.get(span.clone()).unwrap_or("").trim();
    let after = text.get(span.end..).unwrap_or("").trim_start_matches([' ', '\t']);
    if !spanned.is_empty() && spanned.chars().all(is_key) && after.starts_with('=') {
        return (spanned.to_string(), String::new());
    }
    let before = text.get(..span.start).unwrap_or("");
    // If the span of a table begins with its header, the header is the field, and there is no value on one line.
    let brackets = text[span.start..].len() - text[span.start..].trim_start_matches('[').len();
    let inside = &text[span.start + brackets..];
    let line = before.rsplit('\n').next().unwrap_or("");
    let is_header = (brackets > 0 || !line.is_empty()) && line.chars().all(|c| c == '[');
    if is_header && inside.starts_with(char::is_alphabetic) {
        let header = inside.split([']', '\n']).next().unwrap_or("");
        return (header.trim().to_string(), String::new());
    }
    // A name inside a header, as `fish` in `[camera.fish]`: the header is the field.
    let begun = line.trim_start_matches('[');
    if begun.len() < line.len() && begun.starts_with(char::is_alphabetic) && begun.chars().all(is_key) {
        let rest = text[span.start..].split([']', '\n']).next().unwrap_or("");
        return (format!("{begun}{rest}"), String::new());
    }
    let owner = before.rfind('=').map(|at| before[..at].trim_end()).unwrap_or_default();
    let start = owner.char_indices().rev().find(|(_, c)| !is_key(*c)).map_or(0, |(at, c)| at + c.len_utf8());
    let field = owner[start..].to_string();
    let value: String = spanned.lines().next().unwrap_or("").chars().take(80).collect();
    if field.is_empty() { ("definition".to_string(), value) } else { (field, value) }
}

/// Like [`locate`], within the table of that name, up to the next table.
pub fn locate_in(table: &str, text: &str, key: &str, value: &str) -> Option<(usize, usize)> {
    let head = format!("[{table}]");
    let is_line = |at: &usize| text[..*at].is_empty() || text[..*at].ends_with('\n');
    let start = text.match_indices(&head).map(|(at, _)| at).find(is_line)?;
    let end = text[start..].find("\n[").map_or(text.len(), |at| start + at + 1);
    let (line, column) = locate(&text[start..end], key, value)?;
    Some((line + text[..start].matches('\n').count(), column))
}

/// Returns line and column of a value that was found wrong after parsing: its first occurrence behind the key.
pub fn locate(text: &str, key: &str, value: &str) -> Option<(usize, usize)> {
    let at_key = text.match_indices(key).map(|(at, _)| at).find(|at| {
        let starts_line = text[..*at].rsplit('\n').next().is_some_and(|before| before.trim().is_empty());
        starts_line && text[*at + key.len()..].trim_start().starts_with('=')
    })?;
    let at_value = text[at_key + key.len()..].find(value).filter(|_| !value.is_empty());
    Some(line_and_column(text, at_value.map_or(at_key, |at| at_key + key.len() + at)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;
    use serde::de::{Deserializer, Error};

    /// A table that always fails to parse.
    #[derive(Debug)]
    struct Wrong {
        _never_made: u8,
    }

    impl<'de> Deserialize<'de> for Wrong {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
            serde::de::IgnoredAny::deserialize(deserializer)?;
            Err(D::Error::custom("is wrong"))
        }
    }

    #[derive(Debug, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    struct File {
        #[serde(rename = "title")]
        _title: String,
        #[serde(rename = "table")]
        _table: std::collections::BTreeMap<String, Wrong>,
    }

    /// The error names the wrong field and not the field above it.
    #[test]
    fn a_wrong_table_is_named() {
        let said = |text: &str| parse::<File>(text, "f.toml").unwrap_err().to_string();
        let header = said("title = 'a'\n[table.one]\nx = 1\n");
        assert!(header.starts_with("f.toml:2:") && header.contains(" table.one: is wrong"), "{header}");
        let inline = said("title = 'a'\ntable = { one = { x = 1 } }\n");
        assert!(inline.starts_with("f.toml:2:") && inline.contains(" one = { x = 1 }: is wrong"), "{inline}");
        let value = said("title = 'a'\n[table]\none = [\n  [0.5],\n]\n");
        assert!(value.starts_with("f.toml:3:") && value.contains(" one = ["), "{value}");
        let (text, span) = ("base = 'a'\n[camera.fish]\nx = 1\n", 19..23);
        assert_eq!((&text[span.clone()], field_and_value(text, &span).0.as_str()), ("fish", "camera.fish"));
    }
}
