//! The scenes in the binary, and scenes from files.
//!
//! To add one, write `experiments/scenes/NAME.toml`: the build embeds every file there.

use super::Scene;
use super::reader::scene_from_text;
use crate::error::{InputError, Result};
use crate::input::read_text;
use std::path::Path;

/// Name and definition of the scenes that the binary carries.
pub const SCENES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/scenes.rs"));

/// The scene of that name, or the one in the file of that path: whatever ends in `.toml` or has a directory in it is a path.
pub fn load(name_or_path: &str) -> Result<Scene> {
    let path = Path::new(name_or_path);
    if path.extension().is_some_and(|extension| extension == "toml") || path.components().count() > 1 {
        let text = read_text(path)?;
        let stem =
            path.file_stem().map_or_else(|| name_or_path.to_string(), |stem| stem.to_string_lossy().into_owned());
        return scene_from_text(&stem, name_or_path, &text);
    }
    if let Some((name, text)) = SCENES.iter().find(|(name, _)| *name == name_or_path) {
        return scene_from_text(name, &format!("{name}.toml"), text);
    }
    let names: Vec<&str> = SCENES.iter().map(|(name, _)| *name).collect();
    Err(InputError::new("scene", name_or_path, "there is no scene of that name")
        .allowed(format!("{}, or the path of a .toml file", names.join(", ")))
        .into())
}
