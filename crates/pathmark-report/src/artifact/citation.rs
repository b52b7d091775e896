//! `CITATION.cff`: title, authors and licence of an artifact (Citation File Format 1.2).

use super::yaml::{self, Node, Value};
use crate::error::{InputError, Result};
use crate::input::read_text;
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
        let root = yaml::read(file, text)?;
        let all = Fields::of(file, "file", &root)?;
        for name in ["cff-version", "message"] {
            all.required(name)?;
        }
        let title = all.required("title")?;
        let mut authors = Vec::new();
        for node in all.list("authors")? {
            let fields = Fields::of(file, "authors", node)?;
            let text_of = |name: &str| fields.text(name).map(Option::unwrap_or_default);
            let address = text_of("orcid")?;
            let id = if address.is_empty() { Some(String::new()) } else { orcid(&address) };
            let wrong = || fields.refused("orcid", &address, "is not the address of an ORCID");
            let (family, given, name) = (text_of("family-names")?, text_of("given-names")?, text_of("name")?);
            let author = Author { family, given, name, orcid: id.ok_or_else(wrong)? };
            if author.shown().is_empty() {
                return Err(fields.refused("authors", "", "has an author without a name").into());
            }
            authors.push(author);
        }
        if authors.is_empty() {
            return Err(all.refused("authors", "", "is missing or empty").into());
        }
        let licenses = all.list("license")?;
        let licenses = licenses.into_iter().map(|node| all.text_of("license", node)).collect::<Result<_>>()?;
        Ok(Self { title, authors, licenses })
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

/// A mapping of the file, whose keys are texts.
struct Fields<'a> {
    file: &'a str,
    at: (usize, usize),
    entries: Vec<(&'a str, &'a Node)>,
}

impl<'a> Fields<'a> {
    fn of(file: &'a str, name: &str, node: &'a Node) -> Result<Self> {
        let Value::Map(entries) = &node.value else {
            let error = InputError::new(name, "", "has no keys with values");
            return Err(error.in_file(file, Some(node.at)).into());
        };
        let mut found: Vec<(&str, &Node)> = Vec::new();
        for (key, value) in entries {
            let Value::Text(text) = &key.value else { continue };
            if found.iter().any(|(earlier, _)| earlier == text) {
                return Err(InputError::new(text, "", "occurs twice").in_file(file, Some(key.at)).into());
            }
            found.push((text, value));
        }
        Ok(Self { file, at: node.at, entries: found })
    }

    fn get(&self, name: &str) -> Option<&'a Node> {
        self.entries.iter().find(|(key, _)| *key == name).map(|(_, node)| *node)
    }

    /// An error at a field, or at the mapping that lacks it.
    fn refused(&self, name: &str, value: &str, problem: &str) -> InputError {
        let at = self.get(name).map_or(self.at, |node| node.at);
        InputError::new(name, value, problem).in_file(self.file, Some(at))
    }

    fn text(&self, name: &str) -> Result<Option<String>> {
        self.get(name).map(|node| self.text_of(name, node)).transpose()
    }

    fn required(&self, name: &str) -> Result<String> {
        self.text(name)?.ok_or_else(|| self.refused(name, "", "is missing").into())
    }

    /// The items of a list. A single text is a list, too, and so is a field that is missing.
    fn list(&self, name: &str) -> Result<Vec<&'a Node>> {
        match self.get(name) {
            None => Ok(Vec::new()),
            Some(node) => match &node.value {
                Value::List(items) => Ok(items.iter().collect()),
                Value::Text(_) => Ok(vec![node]),
                _ => Err(self.refused(name, "", "is no list").into()),
            },
        }
    }

    fn text_of(&self, name: &str, node: &Node) -> Result<String> {
        let refused =
            |value: &str, problem: &str| InputError::new(name, value, problem).in_file(self.file, Some(node.at)).into();
        match &node.value {
            Value::Text(text) if text.trim().is_empty() => Err(refused(text, "is empty")),
            Value::Text(text) if text.trim().contains(char::is_control) => {
                Err(refused(text, "contains a control character"))
            }
            Value::Text(text) => Ok(text.trim().to_string()),
            _ => Err(refused("", "is no text")),
        }
    }
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
        let author = "authors:\n  - name: A\n";
        let wrong = [
            (format!("{head}title: [a]\n{author}"), "C:3:8: title: is no text"),
            (format!("{head}title: a\ntitle: b\n"), "C:4:1: title: occurs twice"),
            (format!("{head}title: a\nauthors: {{ name: A }}\n"), "C:4:10: authors: is no list"),
            (format!("{head}title: a\nauthors: [A]\n"), "C:4:11: authors: has no keys with values"),
            (format!("{head}title: a\n"), "C:1:1: authors: is missing or empty"),
            (format!("{head}title: a\nauthors:\n  - alias: A\n"), "C:5:5: authors: has an author without a name"),
            (format!("message: m\ntitle: a\n{author}"), "C:1:1: cff-version: is missing"),
            (format!("{head}{author}"), "C:1:1: title: is missing"),
            (format!("{head}title: \"\"\n{author}"), "C:3:8: title: is empty"),
            (format!("{head}title: \"a\\u001b\"\n{author}"), "C:3:8: title = a"),
            (format!("{head}title: &a b\n{author}license: *a\n"), "C:6:10: license: is no list"),
            (format!("{head}title: \"a\n"), "C:"),
            (String::new(), "C:1:1: file: has no keys with values"),
            (
                format!("{head}title: a\n{author}    orcid: \"https://orcid.org/0000-0002-1825-0098\"\n"),
                "C:6:12: orcid = ",
            ),
            (format!("a: {}", "[".repeat(1000)), "C:1:"),
        ];
        for (text, expected) in wrong {
            let told = said(&text);
            assert!(told.starts_with(expected), "{told}\n{text}");
        }
    }

    /// Texts over several lines, flows, comments and anchors, as YAML has them.
    #[test]
    fn any_yaml_is_read() {
        let text = "%YAML 1.2\n---\n# a comment\n{ cff-version: 1.2.0, message: 'it''s', keywords: &k [a, b], other: *k,\n\
                    title: \"Rows of\n  two lines\", authors: [{ family-names: O\u{308}, given-names: A }], license: MIT }\n";
        let found = Citation::from_text("C", text).unwrap();
        assert_eq!((found.title.as_str(), found.names().as_str()), ("Rows of two lines", "A O\u{308}"));
        let folded = "cff-version: 1.2.0\nmessage: m\ntitle: >-\n  Rows\n  of lines\nauthors:\n- name: A\n";
        assert_eq!(Citation::from_text("C", folded).unwrap().title, "Rows of lines");
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
