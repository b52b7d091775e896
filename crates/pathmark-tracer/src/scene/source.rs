//! Where the text of a scene and of its other files comes from: the binary, a user's program, or the disk.

use crate::digest::Fingerprint;
use crate::error::{InputError, Result};
use crate::input::{Limits, Text, open_text, read_text};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

/// Name and definition of the scenes that the binary carries.
pub const SCENES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/scenes.rs"));

/// A scene that a user's program brings along.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OwnScene {
    /// Its name.
    pub name: String,
    /// Its definition in TOML.
    pub text: String,
}

/// Name and text of the meshes that they use.
const MESHES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/meshes.rs"));

/// Where a scene's other files are looked for.
#[derive(Debug, Clone)]
pub(super) enum Folder {
    /// In the binary.
    Embedded,
    /// On disk.
    Disk(PathBuf),
}

impl Folder {
    /// What to call a file of that name in errors.
    pub(super) fn place_of(&self, name: &str) -> String {
        self.path_of(name).map_or_else(|| name.to_string(), |path| path.display().to_string())
    }

    /// Where a file of that name is on disk.
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

/// A file that is being read.
enum Opened {
    Embedded(&'static [u8]),
    Disk(BufReader<Text>),
}

/// The other files of a scene; what is read becomes part of the scene's hash.
pub(super) struct Files<'a> {
    pub(super) folder: &'a Folder,
    pub(super) hash: &'a mut Fingerprint,
    pub(super) read: &'a mut Vec<PathBuf>,
    pub(super) remarks: &'a mut Vec<String>,
}

impl Files<'_> {
    /// Something that the user should hear, once: a file may be used by several objects.
    pub(super) fn remark(&mut self, text: String) {
        if !self.remarks.contains(&text) {
            self.remarks.push(text);
        }
    }

    /// Opens a file of so many bytes at most, and in each of its lines. Whoever reads it puts what is read into the hash.
    pub(super) fn open(&mut self, name: &str, bytes: u64, line: u64) -> Result<Box<dyn BufRead>> {
        let opened = self.folder.open(name, Limits { bytes, line })?;
        self.read.extend(self.folder.path_of(name));
        Ok(match opened {
            Opened::Embedded(text) => Box::new(text),
            Opened::Disk(file) => Box::new(file),
        })
    }
}

/// The text of a scene, what to call it, and where its other files are.
pub(super) struct Source {
    pub(super) name: String,
    pub(super) file: String,
    pub(super) text: String,
    pub(super) folder: Folder,
}

/// The scene in the binary of that name, or the file of that path: whatever ends in `.toml` or has a directory in it is a path. `folder` is
/// where a relative path starts.
pub(super) fn source(name_or_path: &str, folder: &Folder, own: &[OwnScene]) -> Result<Source> {
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
