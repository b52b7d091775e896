//! Scene versions: a scene as it was when an experiment began. Its files may be edited while the experiment runs. Rows
//! of two versions are not repetitions of each other, and must not be measured against each other's references.

use crate::error::{InputError, Result};
use crate::measure::Setup;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The version of a scene, meshes and bases included.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneVersion {
    /// The scene's hash.
    pub hash: String,
    /// The files that it was read from.
    pub files: Vec<PathBuf>,
}

impl SceneVersion {
    /// The version of the scene that a setup has read.
    pub fn of(setup: &Setup) -> Self {
        Self { hash: setup.hash(), files: setup.files().to_vec() }
    }

    /// Refuses another hash: the scene has changed since this version was read.
    pub fn check(&self, hash: &str) -> Result<()> {
        if hash == self.hash {
            return Ok(());
        }
        let files: Vec<String> = self.files.iter().map(|file| file.display().to_string()).collect();
        let problem = format!("has changed since the experiment began: its hash was {}", self.hash);
        let error = InputError::new("scene_hash", hash, problem);
        Err(error.in_file(files.join(" or "), None).into())
    }
}
