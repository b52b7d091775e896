//! Sources of the texts of scenes and of their other files: the binary, a user's program, or the disk.

use crate::digest::Fingerprint;
use crate::error::{InputError, Result};
use crate::input::{Limits, Text, open_text, read_text};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

/// Names and definitions of the scenes that are embedded in the binary.
pub const SCENES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/scenes.rs"));

/// A scene that a user's program provides.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CustomScene {
    pub name: String,
    /// Its definition in TOML.
    pub text: String,
}

/// Names and texts of the meshes that the embedded scenes use.
const MESHES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/meshes.rs"));

/// The location of a scene's other files.
#[derive(Debug, Clone)]
pub(super) enum Folder {
    /// In the binary.
    Embedded,
    Disk(PathBuf),
}

impl Folder {
    /// Returns the name of a file for errors: its path, if it is on disk.
    pub(super) fn place_of(&self, name: &str) -> String {
        self.path_of(name).map_or_else(|| name.to_string(), |path| path.display().to_string())
    }

    /// Returns the path on disk of a file of that name; `None` if files are embedded.
    fn path_of(&self, name: &str) -> Option<PathBuf> {
        match self {
            Self::Embedded => None,
            Self::Disk(folder) => Some(folder.join(name)),
        }
    }

    fn open(&self, name: &str, limits: Limits) -> Result<Opened> {
        match self {
            Self::Disk(folder) => open_text(&folder.join(name), limits).map(Opened::Disk),
            Self::Embedded => match MESHES.iter().find(|(known, _)| *known == name) {
                Some((_, text)) => Ok(Opened::Embedded(text.as_bytes())),
                None => Err(InputError::new("file", name, "there is no such file in the program").into()),
            },
        }
    }
}

/// An open file.
enum Opened {
    Embedded(&'static [u8]),
    Disk(BufReader<Text>),
}

/// The other files of a scene; their contents become part of the scene's hash.
pub(super) struct Files<'a> {
    pub(super) folder: &'a Folder,
    /// The name of the object that needs them.
    pub(super) object: &'a str,
    pub(super) hash: &'a mut Fingerprint,
    pub(super) read: &'a mut Vec<PathBuf>,
    pub(super) remarks: &'a mut Vec<String>,
}

impl Files<'_> {
    /// Adds a remark for the user, once: several objects may use the same file.
    pub(super) fn remark(&mut self, text: String) {
        if !self.remarks.contains(&text) {
            self.remarks.push(text);
        }
    }

    /// Opens a file of at most `bytes` bytes, with at most `line` bytes in each line. The reader must add the contents
    /// to the hash.
    pub(super) fn open(&mut self, name: &str, bytes: u64, line: u64) -> Result<Box<dyn BufRead>> {
        let opened = self.folder.open(name, Limits { bytes, line })?;
        self.read.extend(self.folder.path_of(name));
        Ok(match opened {
            Opened::Embedded(text) => Box::new(text),
            Opened::Disk(file) => Box::new(file),
        })
    }
}

/// The text of a scene, its names for records and errors, and the location of its other files.
pub(super) struct Source {
    pub(super) name: String,
    pub(super) file: String,
    pub(super) text: String,
    pub(super) folder: Folder,
}

/// Returns the scene of that name, embedded or in `own`, or the file at that path. A name that ends in `.toml` or
/// contains a directory is a path. Relative paths start at `folder`.
pub(super) fn source(name_or_path: &str, folder: &Folder, own: &[CustomScene]) -> Result<Source> {
    let path = Path::new(name_or_path);
    if path.extension().is_some_and(|extension| extension == "toml") || path.components().count() > 1 {
        let path = match folder {
            Folder::Disk(folder) => folder.join(path),
            Folder::Embedded => path.to_path_buf(),
        };
        let text = read_text(&path)?;
        let name =
            path.file_stem().map_or_else(|| name_or_path.to_string(), |stem| stem.to_string_lossy().into_owned());
        let folder = Folder::Disk(path.parent().map(Path::to_path_buf).unwrap_or_default());
        return Ok(Source { name, file: path.display().to_string(), text, folder });
    }
    let own = own.iter().map(|scene| (scene.name.as_str(), scene.text.as_str()));
    let known = SCENES.iter().copied().chain(own);
    if let Some((name, text)) = known.clone().find(|(name, _)| *name == name_or_path) {
        let file = format!("{name}.toml");
        return Ok(Source { name: name.to_string(), file, text: text.to_string(), folder: Folder::Embedded });
    }
    let names: Vec<&str> = known.map(|(name, _)| name).collect();
    Err(InputError::new("scene", name_or_path, "there is no scene of that name")
        .allowed(format!("{}, or the path of a .toml file", names.join(", ")))
        .into())
}
