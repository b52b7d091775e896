//! `ro-crate-metadata.json`: the list of an artifact's files with sizes and checksums, in the form of RO-Crate 1.1, and its
//! check.

use super::citation::{Author, Citation};
use crate::error::{Error, InputError, Result};
use crate::input::read_text_up_to;
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

pub(super) const METADATA: &str = "ro-crate-metadata.json";

/// The largest list that is read, in bytes: some hundred thousand files.
const LARGEST: u64 = 64 << 20;

/// A file of the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// Its path in the archive, with `/` between the parts.
    pub path: String,
    pub bytes: u64,
    pub sha256: String,
}

/// The licence of the crate: the identifier of an entity, and the entity.
fn licenses(citation: &Citation) -> Vec<Value> {
    let known = citation
        .licenses
        .iter()
        .map(|id| json!({ "@id": format!("https://spdx.org/licenses/{id}"), "@type": "CreativeWork", "name": id }));
    let unknown = json!({
        "@id": "#license", "@type": "CreativeWork", "name": "unknown", "description": "The authors named no licence."
    });
    if citation.licenses.is_empty() { vec![unknown] } else { known.collect() }
}

fn author(number: usize, author: &Author) -> Value {
    let id = if author.orcid.is_empty() { format!("#author-{number}") } else { author.orcid.clone() };
    if author.name.is_empty() {
        let (family, given, name) = (&author.family, &author.given, author.shown());
        json!({ "@id": id, "@type": "Person", "name": name, "familyName": family, "givenName": given })
    } else {
        json!({ "@id": id, "@type": "Organization", "name": author.name })
    }
}

/// The media type of a file, by its ending.
fn encoding(path: &str) -> &'static str {
    match path.rsplit_once('.').map_or("", |(_, ending)| ending) {
        "csv" => "text/csv",
        "gz" => "application/gzip",
        "toml" => "application/toml",
        "md" => "text/markdown",
        "html" => "text/html",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "json" => "application/json",
        "cff" => "application/yaml",
        "sh" => "application/x-sh",
        _ => "text/plain",
    }
}

/// The text of the list.
pub(super) fn text(files: &[Listed], citation: &Citation, about: &str, date: &str, program: &[String; 2]) -> String {
    let authors: Vec<Value> = citation.authors.iter().enumerate().map(|(at, own)| author(at + 1, own)).collect();
    let licenses = licenses(citation);
    let id_of = |entity: &Value| json!({ "@id": entity["@id"] });
    let ids = |entities: &[Value]| entities.iter().map(id_of).collect::<Vec<Value>>();
    let file = |file: &Listed| {
        json!({
            "@id": encoded(&file.path),
            "@type": "File",
            "name": file.path,
            "encodingFormat": encoding(&file.path),
            "contentSize": file.bytes.to_string(),
            "sha256": file.sha256,
        })
    };
    let files: Vec<Value> = files.iter().map(file).collect();
    let head = json!({
        "@id": METADATA,
        "@type": "CreativeWork",
        "conformsTo": { "@id": "https://w3id.org/ro/crate/1.1" },
        "about": { "@id": "./" },
    });
    let root = json!({
        "@id": "./",
        "@type": "Dataset",
        "name": citation.title,
        "description": about,
        "datePublished": date,
        "license": ids(&licenses),
        "author": ids(&authors),
        "mentions": { "@id": "#program" },
        "hasPart": ids(&files),
    });
    let program = json!({
        "@id": "#program",
        "@type": "SoftwareApplication",
        "name": program[0],
        "version": program[1],
        "url": env!("CARGO_PKG_REPOSITORY"),
    });
    let graph: Vec<Value> = [head, root, program].into_iter().chain(authors).chain(licenses).chain(files).collect();
    // The context of RO-Crate 1.1 has no word for checksums.
    let context = json!(["https://w3id.org/ro/crate/1.1/context", { "sha256": "http://schema.org/sha256" }]);
    format!("{:#}\n", json!({ "@context": context, "@graph": graph }))
}

/// A path as an identifier, which is a reference of a URI.
fn encoded(path: &str) -> String {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte);
    let encode = |byte: u8| if is_plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") };
    path.bytes().map(encode).collect()
}

/// The path of an identifier; `None` if it is none.
fn decoded(id: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(id.len());
    let mut rest = id.bytes();
    while let Some(byte) = rest.next() {
        if byte == b'%' {
            let digits = [rest.next()?, rest.next()?].map(|digit| char::from(digit).to_digit(16));
            bytes.push((16 * digits[0]? + digits[1]?) as u8);
        } else {
            bytes.push(byte);
        }
    }
    String::from_utf8(bytes).ok()
}

/// The files below a folder, by their paths in it. Refuses links and special files: they lead out of an archive.
pub(super) fn files_below(root: &Path) -> Result<BTreeMap<String, PathBuf>> {
    let (mut files, mut folders) = (BTreeMap::new(), vec![(String::new(), root.to_path_buf())]);
    while let Some((name, folder)) = folders.pop() {
        let system = |e| Error::system("reading", &folder, e);
        for entry in fs::read_dir(&folder).map_err(system)? {
            let entry = entry.map_err(system)?;
            let (path, kind) = (entry.path(), entry.file_type().map_err(system)?);
            let refused = |problem: &str| InputError::new("file", path.display().to_string(), problem);
            let Some(own) = entry.file_name().to_str().map(|own| format!("{name}{own}")) else {
                return Err(refused("has a name that is not UTF-8 text").into());
            };
            if kind.is_dir() {
                folders.push((format!("{own}/"), path));
            } else if kind.is_file() {
                files.insert(own, path);
            } else {
                return Err(refused("is neither a file nor a folder, as all of an archive are").into());
            }
        }
    }
    Ok(files)
}

/// A file as the list has it.
pub(super) fn look_at(name: &str, path: &Path) -> Result<Listed> {
    let system = |e| Error::system("reading", path, e);
    let mut file = File::open(path).map_err(system)?;
    let (mut digest, mut bytes, mut buffer) = (Sha256::new(), 0, vec![0; 1 << 16]);
    loop {
        match file.read(&mut buffer).map_err(system)? {
            0 => break,
            count => {
                digest.update(&buffer[..count]);
                bytes += count as u64;
            }
        }
    }
    let mut sha256 = String::with_capacity(64);
    for byte in &digest.finalize() {
        // Writing to a string cannot fail.
        let _ = write!(sha256, "{byte:02x}");
    }
    Ok(Listed { path: name.to_string(), bytes, sha256 })
}

/// The line of a value of an entity in our own lists; other programs may write them in another form.
fn place(text: &str, id: &str, value: &str) -> Option<(usize, usize)> {
    let start = text.rfind(&format!("\"@id\": \"{id}\""))? + 1;
    let entity = text[start..].split("\"@id\"").next()?;
    let at = start + entity.find(&format!("\"{value}\"")).unwrap_or(0);
    Some((text[..at].matches('\n').count() + 1, 1))
}

/// The files of a list, each with its identifier.
fn entities(file: &str, text: &str) -> Result<Vec<(String, Listed)>> {
    let refused = |field: &str, value: &str, problem: &str| InputError::new(field, value, problem);
    let json: Value = serde_json::from_str(text).map_err(|e| {
        let at = Some((e.line(), e.column().max(1)));
        refused("JSON", "", &format!("cannot be read: {e}")).in_file(file, at)
    })?;
    let Some(graph) = json["@graph"].as_array() else {
        return Err(refused("@graph", "", "is missing, or is no list").in_file(file, None).into());
    };
    let text_of = |entity: &Map<String, Value>, key: &str| entity.get(key).and_then(Value::as_str).map(str::to_string);
    let has_type = |entity: &Map<String, Value>, wanted: &str| match entity.get("@type") {
        Some(Value::Array(all)) => all.iter().any(|own| own == wanted),
        Some(own) => own == wanted,
        None => false,
    };
    let (mut found, mut has_root) = (Vec::new(), false);
    for entity in graph.iter().filter_map(Value::as_object) {
        let Some(id) = text_of(entity, "@id") else {
            return Err(refused("@id", "", "is missing in an entity").in_file(file, None).into());
        };
        has_root |= id == "./" && has_type(entity, "Dataset");
        // Entities with an address are elsewhere.
        if !has_type(entity, "File") || id.contains("://") {
            continue;
        }
        let wrong = |field: &str, value: &str, problem: &str| {
            let problem = format!("{problem} (of {id})");
            Error::from(refused(field, value, &problem).in_file(file, place(text, &id, value)))
        };
        let path =
            decoded(id.trim_start_matches("./")).ok_or_else(|| wrong("@id", &id, "is not the path of a file"))?;
        let sha256 = text_of(entity, "sha256").unwrap_or_default();
        if sha256.len() != 64 || !sha256.chars().all(|digit| digit.is_ascii_hexdigit()) {
            return Err(wrong("sha256", &sha256, "does not have 64 hexadecimal digits"));
        }
        let size = entity.get("contentSize").map(|size| size.as_str().map_or_else(|| size.to_string(), str::to_string));
        let size = size.unwrap_or_default();
        let bytes = size.parse::<u64>().map_err(|_| wrong("contentSize", &size, "is not a number of bytes"))?;
        found.push((id, Listed { path, bytes, sha256: sha256.to_lowercase() }));
    }
    if !has_root {
        return Err(refused("@id", "./", "is missing: it is the entity of the archive").in_file(file, None).into());
    }
    Ok(found)
}

/// Reads a list of files.
pub fn listed(path: &Path) -> Result<Vec<Listed>> {
    let entities = entities(&path.display().to_string(), &read_text_up_to(path, LARGEST)?)?;
    Ok(entities.into_iter().map(|(_, listed)| listed).collect())
}

/// Checks that an archive has the listed files and no others, all with their sizes and checksums, and among them those
/// `needed`. Returns how many there are.
pub(super) fn check(archive: &Path, needed: &[&str]) -> Result<usize> {
    let path = archive.join(METADATA);
    let (file, text) = (path.display().to_string(), read_text_up_to(&path, LARGEST)?);
    let mut there = files_below(archive)?;
    there.remove(METADATA);
    let listed = entities(&file, &text)?;
    if let Some(missing) = needed.iter().find(|needed| !listed.iter().any(|(_, own)| own.path == **needed)) {
        return Err(InputError::new("@id", *missing, "is not listed, and every artifact has it")
            .in_file(file, None)
            .into());
    }
    for (id, own) in &listed {
        let wrong = |field: &str, value: &str, problem: String| {
            Error::from(InputError::new(field, value, problem).in_file(&file, place(&text, id, value)))
        };
        let Some(path) = there.remove(&own.path) else {
            return Err(wrong("@id", id, "there is no such file, or it is listed twice".to_string()));
        };
        let found = look_at(&own.path, &path)?;
        if found.bytes != own.bytes {
            let problem = format!("{} has {} bytes", own.path, found.bytes);
            return Err(wrong("contentSize", &own.bytes.to_string(), problem));
        }
        if found.sha256 != own.sha256 {
            return Err(wrong("sha256", &own.sha256, format!("{} has {}", own.path, found.sha256)));
        }
    }
    match there.values().next() {
        None => Ok(listed.len()),
        Some(path) => {
            let problem = format!("is not listed in {METADATA}");
            Err(InputError::new("file", path.display().to_string(), problem).into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_paths() {
        for path in ["rows/a b/r%ecords.csv", "é/ü.toml", "plain-1_2.~x"] {
            let id = encoded(path);
            assert!(id.is_ascii() && !id.contains(' '), "{id}");
            assert_eq!(decoded(&id).as_deref(), Some(path));
        }
        assert_eq!((decoded("a%2"), decoded("a%zz"), decoded("%ff")), (None, None, None));
    }

    /// The list of an invented archive is read back, and wrong lists are told with field and line.
    #[test]
    fn lists_are_read_back_and_wrong_ones_refused() {
        let file = Listed { path: "rows/a b.csv".to_string(), bytes: 3, sha256: "0".repeat(64) };
        let citation = Citation::choose(None, &[], None, Path::new("no/such/file")).unwrap();
        let program = ["pathmark".to_string(), "0".to_string()];
        let whole = text(std::slice::from_ref(&file), &citation, "about", "2026-01-31", &program);
        assert_eq!(entities("C", &whole).unwrap(), [("rows/a%20b.csv".to_string(), file)]);
        let said = |text: &str| entities("C", text).unwrap_err().to_string();
        assert!(said(&whole[..whole.len() / 2]).starts_with("C:"));
        assert!(said("{}").starts_with("C: @graph: "));
        assert!(said(&whole.replace("\"./\"", "\"x/\"")).contains("@id = ./"));
        let wrong = whole.replace("\"contentSize\": \"3\"", "\"contentSize\": \"many\"");
        let line = wrong.lines().position(|line| line.contains("many")).unwrap() + 1;
        assert!(said(&wrong).starts_with(&format!("C:{line}:1: contentSize = many: ")), "{}", said(&wrong));
        assert!(said(&whole.replace(&"0".repeat(64), "00")).contains("sha256 = 00: "));
    }
}
