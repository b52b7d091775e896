//! A scene as it was when an experiment began. Its files may be edited while the experiment runs; rows of two versions are no repetitions of each
//! other, and rows of one must not be measured against references of the other.

use crate::error::{InputError, Result};
use crate::measure::Setup;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What tells versions of a scene apart, meshes and bases included.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneVersion {
    /// The scene's hash.
    pub hash: String,
    /// The files that it was read from.
    pub files: Vec<PathBuf>,
}

impl SceneVersion {
    /// What a setup has read.
    pub fn of(setup: &Setup) -> Self {
        Self { hash: setup.hash(), files: setup.files().to_vec() }
    }

    /// Refuses the hash of a scene that was read again and is another one by now.
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
