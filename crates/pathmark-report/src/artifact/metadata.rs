//! `ro-crate-metadata.json`: the list of an artifact's files with sizes and checksums, in the form of RO-Crate 1.1, and its
//! check.

use super::citation::{Author, Citation};
use super::recipes::Program;
use crate::error::{Error, InputError, Result};
use crate::input::read_text_up_to;
use crate::page::href;
use crate::time::is_date;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
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
pub(super) fn text(files: &[Listed], citation: &Citation, about: &str, date: &str, program: &Program) -> String {
    let authors: Vec<Value> = citation.authors.iter().enumerate().map(|(at, own)| author(at + 1, own)).collect();
    let licenses = licenses(citation);
    let id_of = |entity: &Value| json!({ "@id": entity["@id"] });
    let ids = |entities: &[Value]| entities.iter().map(id_of).collect::<Vec<Value>>();
    let file = |file: &Listed| {
        json!({
            "@id": href(&file.path),
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
    let Program { name, version, address, .. } = program;
    let mut program = json!({ "@id": "#program", "@type": "SoftwareApplication", "name": name, "version": version });
    if let Some(address) = address {
        program["url"] = json!(address);
    }
    let graph: Vec<Value> = [head, root, program].into_iter().chain(authors).chain(licenses).chain(files).collect();
    // The context of RO-Crate 1.1 has no word for checksums.
    let context = json!(["https://w3id.org/ro/crate/1.1/context", { "sha256": "http://schema.org/sha256" }]);
    format!("{:#}\n", json!({ "@context": context, "@graph": graph }))
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

fn has_type(entity: &Value, wanted: &str) -> bool {
    match &entity["@type"] {
        Value::Array(all) => all.iter().any(|own| own == wanted),
        own => own == wanted,
    }
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
    let text_of = |entity: &Value, key: &str| entity[key].as_str().map(str::to_string);
    check_head(file, text, graph)?;
    let parts = parts(graph);
    let mut found = Vec::new();
    for entity in graph.iter().filter(|entity| entity.is_object()) {
        let Some(id) = text_of(entity, "@id") else {
            return Err(refused("@id", "", "is missing in an entity").in_file(file, None).into());
        };
        // Entities with an address are elsewhere.
        if !has_type(entity, "File") || id.contains("://") {
            continue;
        }
        let wrong = |field: &str, value: &str, problem: &str| {
            let problem = format!("{problem} (of {id})");
            Error::from(refused(field, value, &problem).in_file(file, place(text, &id, value)))
        };
        if !parts.contains(id.as_str()) {
            return Err(wrong("hasPart", "", "lacks a file: no chain of `hasPart` leads to it from ./"));
        }
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
    Ok(found)
}

/// The identifiers that a property of an entity names: one, or those of a list.
fn ids<'a>(entity: &'a Value, key: &str) -> Vec<&'a str> {
    let of = |value: &'a Value| value["@id"].as_str();
    match &entity[key] {
        Value::Array(all) => all.iter().filter_map(of).collect(),
        one => of(one).into_iter().collect(),
    }
}

/// Checks the entities of the list itself and of the archive, as RO-Crate requires them.
fn check_head(file: &str, text: &str, graph: &[Value]) -> Result<()> {
    let entity = |id: &str| graph.iter().find(|entity| entity["@id"] == id);
    let wrong = |id: &str, field: &str, value: &str, problem: &str| {
        let error = InputError::new(field, value, format!("{problem} (of {id})"));
        Err(Error::from(error.in_file(file, place(text, id, value))))
    };
    let (Some(head), Some(root)) = (entity(METADATA), entity("./")) else {
        let id = if entity("./").is_some() { METADATA } else { "./" };
        let error = InputError::new("@id", id, "is missing: an RO-Crate describes its list and its folder");
        return Err(error.in_file(file, None).into());
    };
    if !has_type(root, "Dataset") {
        return wrong("./", "@type", "", "is not Dataset");
    }
    let conforms = ids(head, "conformsTo");
    if !conforms.iter().any(|id| id.starts_with("https://w3id.org/ro/crate/1.")) {
        return wrong(METADATA, "conformsTo", conforms.first().unwrap_or(&""), "names no version of RO-Crate");
    }
    if ids(head, "about") != ["./"] {
        return wrong(METADATA, "about", "", "is not ./");
    }
    for key in ["name", "description", "datePublished"] {
        if root[key].as_str().is_none_or(|text| text.trim().is_empty()) {
            return wrong("./", key, "", "is missing or empty");
        }
    }
    let date = root["datePublished"].as_str().unwrap_or_default();
    if !date.get(..10).is_some_and(is_date) {
        return wrong("./", "datePublished", date, "does not begin with a date such as 2026-01-31");
    }
    for key in ["license", "hasPart"] {
        if ids(root, key).is_empty() && root[key].as_str().is_none_or(str::is_empty) {
            return wrong("./", key, "", "is missing or empty");
        }
    }
    Ok(())
}

/// The entities that belong to the archive, directly or by a folder within it.
fn parts(graph: &[Value]) -> BTreeSet<&str> {
    let of: BTreeMap<&str, Vec<&str>> =
        graph.iter().filter_map(|entity| Some((entity["@id"].as_str()?, ids(entity, "hasPart")))).collect();
    let (mut found, mut rest) = (BTreeSet::new(), vec!["./"]);
    while let Some(id) = rest.pop() {
        let own = of.get(id).into_iter().flatten().copied();
        rest.extend(own.filter(|part| found.insert(*part)));
    }
    found
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
    // Before any file is read, because links are refused.
    let mut there = files_below(archive)?;
    there.remove(METADATA);
    let (file, text) = (path.display().to_string(), read_text_up_to(&path, LARGEST)?);
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
    use crate::lab::Lab;

    #[test]
    fn identifiers_are_paths() {
        for path in ["rows/a b/r%ecords.csv", "é/ü.toml", "plain-1_2.~x"] {
            let id = href(path);
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
        let program = Program::of(&Lab::built_in());
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

        // Without a property that RO-Crate requires, or with a wrong one.
        let with = |id: &str, key: &str, value: Value| {
            let mut list: Value = serde_json::from_str(&whole).unwrap();
            let entities = list["@graph"].as_array_mut().unwrap();
            entities.iter_mut().find(|entity| entity["@id"] == id).unwrap()[key] = value;
            list.to_string()
        };
        for (id, keys) in [
            (METADATA, &["about", "conformsTo"][..]),
            ("./", &["@type", "name", "description", "datePublished", "license", "hasPart"]),
        ] {
            for key in keys {
                let told = said(&with(id, key, Value::Null));
                assert!(told.contains(&format!("{key}: ")) && told.contains(&format!("(of {id})")), "{told}");
            }
        }
        assert!(
            said(&whole.replace("\"@id\": \"ro-crate-metadata.json\"", "\"@id\": \"x\"")).contains("@id = ro-crate")
        );
        assert!(said(&with("./", "datePublished", json!("today"))).contains("datePublished = today: "));
        let other = json!({ "@id": "https://w3id.org/workflowhub" });
        assert!(said(&with(METADATA, "conformsTo", other)).contains("conformsTo = https://w3id.org/workflowhub: "));
        // A file may be part of a folder; one that is part of nothing is refused.
        let folder = with("./", "hasPart", json!([{ "@id": "#author-1" }]));
        assert!(said(&folder).contains("hasPart: lacks a file") && said(&folder).contains("(of rows/a%20b.csv)"));
        let folder =
            folder.replace("\"@id\":\"#author-1\",", "\"@id\":\"#author-1\",\"hasPart\":{\"@id\":\"rows/a%20b.csv\"},");
        assert_eq!(entities("C", &folder).unwrap().len(), 1, "{folder}");
    }
}
