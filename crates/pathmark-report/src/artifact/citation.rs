//! `CITATION.cff`: title, authors and licence of an artifact.
//!
//! Of the Citation File Format we read the part that such files use: texts on one line, and lists of authors and licences.
//! Any other YAML in these fields is refused with its line.

use crate::error::{InputError, Result};
use crate::input::read_text;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

/// The name of such files.
pub const CITATION: &str = "CITATION.cff";

const UNKNOWN_TITLE: &str = "Unknown title";
const UNKNOWN_AUTHOR: &str = "Unknown author";
const ORCID: &str = "https://orcid.org/";

/// A person, or an organization, which only has a name.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Author {
    pub(super) family: String,
    pub(super) given: String,
    pub(super) name: String,
    /// An address; empty without one.
    pub(super) orcid: String,
}

#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Citation {
    pub(super) title: String,
    pub(super) authors: Vec<Author>,
    /// Identifiers of the SPDX list; none if the licence is unknown.
    pub(super) licenses: Vec<String>,
}

impl Author {
    /// Reads `Family, Given <ORCID>`; the ORCID may be missing. A name without a comma is that of an organization.
    fn parse(text: &str) -> Result<Self> {
        let refused = |problem: &str| {
            let allowed = "\"Family, Given <0000-0002-1825-0097>\", with or without an ORCID, or an organization";
            InputError::new("author", text, problem).allowed(allowed)
        };
        if text.contains(char::is_control) {
            return Err(refused("contains a control character").into());
        }
        let (name, orcid) = match text.trim().strip_suffix('>').map(|rest| rest.rsplit_once('<')) {
            None => (text.trim(), String::new()),
            Some(None) => return Err(refused("has no `<` before its `>`").into()),
            Some(Some((name, id))) => (name.trim(), orcid(id).ok_or_else(|| refused("has a wrong ORCID"))?),
        };
        let author = match name.split_once(',') {
            Some((family, given)) => {
                Self { family: family.trim().to_string(), given: given.trim().to_string(), orcid, ..Self::default() }
            }
            None => Self { name: name.to_string(), orcid, ..Self::default() },
        };
        if author.shown().is_empty() { Err(refused("is empty").into()) } else { Ok(author) }
    }

    pub(super) fn shown(&self) -> String {
        let parts = [&self.given, &self.family, &self.name].into_iter().filter(|part| !part.is_empty());
        parts.cloned().collect::<Vec<String>>().join(" ")
    }

    /// Its keys and values in a citation file.
    fn fields(&self) -> impl Iterator<Item = (&'static str, &String)> {
        let all = [
            ("family-names", &self.family),
            ("given-names", &self.given),
            ("name", &self.name),
            ("orcid", &self.orcid),
        ];
        all.into_iter().filter(|(_, value)| !value.is_empty())
    }
}

/// The address of an ORCID, whose last digit checks the others (ISO 7064, MOD 11-2).
fn orcid(text: &str) -> Option<String> {
    let id = text.trim().trim_start_matches(ORCID);
    let (most, check) = id.split_at_checked(18)?;
    let has_hyphens = id.len() == 19 && [4, 9, 14].iter().all(|at| id.as_bytes()[*at] == b'-');
    let digits: Vec<u32> =
        most.chars().filter(|char| *char != '-').map(|char| char.to_digit(10)).collect::<Option<_>>()?;
    let rest = digits.iter().fold(0, |sum, digit| (sum + digit) * 2 % 11);
    let expected = match (12 - rest) % 11 {
        10 => "X".to_string(),
        digit => digit.to_string(),
    };
    (has_hyphens && digits.len() == 15 && check == expected).then(|| format!("{ORCID}{id}"))
}

impl Citation {
    /// The citation that the options give. A missing option is taken from the file `beside`, if it is there, and is
    /// named as unknown otherwise.
    pub fn choose(title: Option<&str>, authors: &[String], license: Option<&str>, beside: &Path) -> Result<Self> {
        let own = authors.iter().map(|author| Author::parse(author)).collect::<Result<Vec<Author>>>()?;
        for (field, value) in [("title", title), ("license", license)] {
            if value.is_some_and(|value| value.trim().is_empty() || value.contains(char::is_control)) {
                let problem = "is empty or contains a control character";
                return Err(InputError::new(field, value.unwrap_or_default(), problem).into());
            }
        }
        let is_spdx = |license: &str| license.chars().all(|char| char.is_ascii_alphanumeric() || "-.+".contains(char));
        if let Some(license) = license.filter(|license| !is_spdx(license)) {
            let error = InputError::new("license", license, "is not an identifier of the SPDX list");
            return Err(error.allowed("for example CC-BY-4.0 or MIT").into());
        }
        let needs_file = title.is_none() || own.is_empty() || license.is_none();
        let file = if needs_file && beside.is_file() { Self::read(beside)? } else { Self::default() };
        let unknown = || vec![Author { name: UNKNOWN_AUTHOR.to_string(), ..Author::default() }];
        let or = |own: Vec<Author>, other: Vec<Author>| if own.is_empty() { other } else { own };
        let known = Some(file.title).filter(|title| !title.is_empty());
        Ok(Self {
            title: title.map(str::to_string).or(known).unwrap_or_else(|| UNKNOWN_TITLE.to_string()),
            authors: or(or(own, file.authors), unknown()),
            licenses: license.map_or(file.licenses, |license| vec![license.to_string()]),
        })
    }

    pub fn read(path: &Path) -> Result<Self> {
        Self::from_text(&path.display().to_string(), &read_text(path)?)
    }

    fn from_text(file: &str, text: &str) -> Result<Self> {
        let mut found = Self::default();
        let (mut key, mut seen) = (String::new(), BTreeSet::new());
        for (index, line) in text.lines().enumerate() {
            let refused = |field: &str, value: &str, problem: &str| {
                InputError::new(field, value, problem).in_file(file, Some((index + 1, 1)))
            };
            let content = line.trim();
            if content.is_empty() || content.starts_with('#') || content == "---" {
                continue;
            }
            let is_item = content.starts_with("- ");
            let is_nested = is_item || line.starts_with(' ');
            // The values of other keys may be any YAML.
            if is_nested && !matches!(key.as_str(), "authors" | "license") {
                continue;
            }
            let content = content.strip_prefix("- ").unwrap_or(content).trim_start();
            let text_of = |field: &str, value: &str| -> Result<String> {
                let problem = "is not a text on one line, and we read no other YAML here";
                scalar(value).ok_or_else(|| refused(field, value, problem).into())
            };
            if is_nested && key == "license" {
                found.licenses.push(text_of("license", content)?);
                continue;
            }
            let (name, value) =
                content.split_once(':').ok_or_else(|| refused("line", content, "has no `key: value`"))?;
            let (name, value) = (name.trim(), value.trim());
            if is_nested {
                if is_item {
                    found.authors.push(Author::default());
                }
                let Some(author) = found.authors.last_mut() else {
                    return Err(refused("authors", content, "does not begin with `- `").into());
                };
                match name {
                    "family-names" => author.family = text_of(name, value)?,
                    "given-names" => author.given = text_of(name, value)?,
                    "name" => author.name = text_of(name, value)?,
                    "orcid" => {
                        author.orcid = orcid(&text_of(name, value)?)
                            .ok_or_else(|| refused(name, value, "is not the address of an ORCID"))?;
                    }
                    _ => {}
                }
                continue;
            }
            if !seen.insert(name.to_string()) {
                return Err(refused(name, value, "occurs twice").into());
            }
            key = name.to_string();
            match name {
                "title" => found.title = text_of(name, value)?,
                "license" if !value.is_empty() => found.licenses.push(text_of(name, value)?),
                "cff-version" | "message" => {
                    text_of(name, value)?;
                }
                _ => {}
            }
        }
        let missing = |name: &str| InputError::new(name, "", "is missing").in_file(file, None);
        if let Some(name) = ["cff-version", "message", "title"].into_iter().find(|name| !seen.contains(*name)) {
            return Err(missing(name).into());
        }
        if found.authors.is_empty() || found.authors.iter().any(|author| author.shown().is_empty()) {
            return Err(missing("name of an author").into());
        }
        Ok(found)
    }

    /// The text of a citation file.
    pub(super) fn to_cff(&self, date: &str) -> String {
        let mut text = format!(
            "cff-version: 1.2.0\nmessage: \"If you use this artifact, please cite it as below.\"\ntype: dataset\n\
             title: {}\nauthors:\n",
            quoted(&self.title)
        );
        for author in &self.authors {
            for (at, (key, value)) in author.fields().enumerate() {
                let head = if at == 0 { "  - " } else { "    " };
                // Writing to a string cannot fail.
                let _ = writeln!(text, "{head}{key}: {}", quoted(value));
            }
        }
        let _ = writeln!(text, "date-released: {date}");
        match self.licenses.as_slice() {
            [] => {}
            [one] => {
                let _ = writeln!(text, "license: {}", quoted(one));
            }
            several => {
                text += "license:\n";
                for license in several {
                    let _ = writeln!(text, "  - {}", quoted(license));
                }
            }
        }
        text
    }

    /// The licences in words.
    pub(super) fn license(&self) -> String {
        if self.licenses.is_empty() { "unknown".to_string() } else { self.licenses.join(" or ") }
    }

    pub(super) fn names(&self) -> String {
        self.authors.iter().map(Author::shown).collect::<Vec<String>>().join(", ")
    }
}

/// A text in double quotes, which YAML has in common with JSON.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// The text of a YAML scalar on one line; `None` for other YAML.
fn scalar(value: &str) -> Option<String> {
    let text = match value.chars().next()? {
        '"' => serde_json::from_str(value).ok()?,
        '\'' => value.strip_prefix('\'')?.strip_suffix('\'')?.replace("''", "'"),
        '[' | ']' | '{' | '}' | '&' | '*' | '!' | '|' | '>' | '%' | '@' | '`' | '#' => return None,
        _ => value.split(" #").next()?.trim_end().to_string(),
    };
    Some(text).filter(|text: &String| !text.trim().is_empty() && !text.contains(char::is_control))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(text: &str) -> String {
        Citation::from_text("C", text).unwrap_err().to_string()
    }

    /// The ORCID is the example of orcid.org.
    #[test]
    fn a_written_citation_is_read_back() {
        let authors =
            ["Carberry, Josiah <0000-0002-1825-0097>", "O'Hara: \"X\" \\ #1, A", "The group"].map(String::from);
        let nowhere = Path::new("no/such/file");
        let made = Citation::choose(Some("Rows: a \"study\" # 1"), &authors, Some("CC-BY-4.0"), nowhere).unwrap();
        assert_eq!(Citation::from_text("C", &made.to_cff("2026-01-31")).unwrap(), made);
        assert_eq!(made.authors[0].orcid, "https://orcid.org/0000-0002-1825-0097");
        assert_eq!(made.names(), "Josiah Carberry, A O'Hara: \"X\" \\ #1, The group");
        let unknown = Citation::choose(None, &[], None, nowhere).unwrap();
        assert_eq!((unknown.names().as_str(), unknown.license().as_str()), ("Unknown author", "unknown"));
        assert_eq!(Citation::from_text("C", &unknown.to_cff("2026-01-31")).unwrap(), unknown);
    }

    #[test]
    fn options_replace_parts_of_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(CITATION);
        let text = "# ours\ncff-version: 1.2.0\nmessage: 'it''s'\nabstract: >\n  any: [yaml\ntitle: Rows # new\nauthors:\n- name: A\n\
                    \x20 alias: a\nlicense:\n  - MIT\n  - Apache-2.0\n";
        std::fs::write(&path, text).unwrap();
        let of = |title, authors: &[String], license| Citation::choose(title, authors, license, &path).unwrap();
        let all = of(None, &[], None);
        assert_eq!(
            (all.title.as_str(), all.names().as_str(), all.license().as_str()),
            ("Rows", "A", "MIT or Apache-2.0")
        );
        let some = of(Some("T"), &["B, C".to_string()], None);
        assert_eq!((some.title.as_str(), some.names().as_str(), some.licenses.len()), ("T", "C B", 2));
    }

    #[test]
    fn wrong_citations_are_told_with_their_line() {
        let head = "cff-version: 1.2.0\nmessage: m\n";
        assert!(said(&format!("{head}title: [a]\n")).starts_with("C:3:1: title = [a]: "));
        assert!(said(&format!("{head}title: a\ntitle: b\n")).starts_with("C:4:1: title = b: occurs twice"));
        assert!(said(&format!("{head}title: a\nauthors:\n  name: A\n")).starts_with("C:5:1: authors = name: A: "));
        assert!(said(&format!("{head}title: a\n")).starts_with("C: name of an author: is missing"));
        assert!(said("message: m\ntitle: a\n").starts_with("C: cff-version: is missing"));
        let wrong =
            format!("{head}title: a\nauthors:\n  - name: A\n    orcid: \"https://orcid.org/0000-0002-1825-0098\"\n");
        assert!(said(&wrong).starts_with("C:6:1: orcid = "), "{}", said(&wrong));
    }

    #[test]
    fn wrong_options_name_what_is_allowed() {
        let nowhere = Path::new("no/such/file");
        for author in ["", "A, B <0000-0002-1825-0098>", "A >", "a\u{1b}", " , "] {
            let error = Author::parse(author).unwrap_err().to_string();
            assert!(error.contains("Family, Given"), "{error}");
        }
        for license in ["", "MIT or so", "a/b"] {
            assert!(Citation::choose(None, &[], Some(license), nowhere).is_err(), "{license}");
        }
    }
}
