//! The library of named scenes, and scenes from files and texts.
//!
//! To add one, write `experiments/scenes/NAME.toml`: the build embeds every file there. A user's program adds scenes as
//! text.

use super::Scene;
use super::reader::{estimator_of_text, scene_from_text};
use super::source::{CustomScene, Folder, SCENES, Source, source};
use crate::error::Result;
use std::path::PathBuf;

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
