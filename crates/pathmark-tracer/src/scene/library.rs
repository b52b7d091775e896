//! The library of named scenes, and scenes from files and texts: in the binary, in a user's program, or on disk.
//!
//! To add one, write `experiments/scenes/NAME.toml`: the build embeds every file there. A user's program adds scenes as
//! text.

use super::Scene;
use super::reader::{estimator_of_text, scene_from_text};
use crate::digest::Fingerprint;
use crate::error::{InputError, Result};
use crate::input::{Limits, Text, open_text, read_text};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

/// The embedded scenes, and the scenes that a user's program adds.
#[derive(Debug, Clone, Default)]
pub struct Library {
    own: Vec<CustomScene>,
}

impl Library {
    pub fn add(&mut self, scene: CustomScene) {
        self.own.push(scene);
    }

    /// The names, in the order in which they are listed.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        SCENES.iter().map(|(name, _)| *name).chain(self.own.iter().map(|scene| scene.name.as_str()))
    }

    /// Loads the scene of that name or the file at that path. A number after a colon is for the scene's generator:
    /// `spheres:1000`.
    pub fn load(&self, name_or_path: &str) -> Result<Scene> {
        let (base, number) = split(name_or_path);
        scene_from_text(source(base, &Folder::Disk(PathBuf::new()), &self.own)?, number, &self.own)
    }

    /// Returns [`Scene::estimator`] of that scene from its text alone: it reads no mesh and generates nothing.
    pub fn estimator_of(&self, name_or_path: &str) -> Result<String> {
        estimator_of_text(source(split(name_or_path).0, &Folder::Disk(PathBuf::new()), &self.own)?, &self.own)
    }
}

/// Splits a scene's name or path from the number after a colon, which comes with its text.
fn split(name_or_path: &str) -> (&str, Option<(f64, &str)>) {
    let parts = name_or_path.rsplit_once(':');
    let found = parts.and_then(|(base, number)| Some((base, Some((number.parse().ok()?, number)))));
    found.unwrap_or((name_or_path, None))
}

/// Loads the embedded scene of that name or the file at that path, like [`Library::load`].
pub fn load(name_or_path: &str) -> Result<Scene> {
    Library::default().load(name_or_path)
}

impl Scene {
    /// Reads a scene from its text. Files that it names are looked for relative to the current folder.
    ///
    /// ```
    /// # use pathmark_tracer as pathmark;
    /// use pathmark::scene::Scene;
    ///
    /// let scene = Scene::from_toml("about = 'a room with green walls'\nbase = 'cornell'\nwithout = ['glass ball']")?;
    /// assert_eq!(scene.objects.len(), 8);
    /// # Ok::<(), pathmark::error::Error>(())
    /// ```
    pub fn from_toml(text: &str) -> Result<Self> {
        let (name, file) = ("scene".to_string(), "scene.toml".to_string());
        scene_from_text(Source { name, file, text: text.to_string(), folder: Folder::Disk(PathBuf::new()) }, None, &[])
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_alone_tells_the_estimator() {
        let library = Library::default();
        for name in library.names().chain(["spheres:100"]) {
            assert_eq!(library.estimator_of(name).unwrap(), library.load(name).unwrap().estimator(), "{name}");
        }
        assert_eq!(library.estimator_of("cornell").unwrap(), "smallpt");
    }
}
