//! References: two independent halves against which images are measured, from seeds that no image under test can have.
//!
//! With two halves R₁ and R₂ the mean of (T - R₁)(T - R₂) is the image's squared error without the references' own noise
//! (docs/errors.md: cross form).

use super::{Cell, Definition, Profile, SceneVersion};
use crate::atomic_file;
use crate::error::{InputError, Result};
use crate::film_file::{FilmKey, read_film};
use crate::kernel::Spec;
use crate::lab::Lab;
use crate::measure::{Settings, Setup, available_threads};
use crate::sampling::{REFERENCE_SEEDS, SAMPLERS, is_deterministic};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The seed of a half: above every seed that an image may have.
pub fn reference_seed(half: u32) -> u64 {
    REFERENCE_SEEDS + u64::from(half)
}

/// The scene and the settings of a reference.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reference {
    /// Scene: a name or a path.
    pub scene: String,
    /// The required version of the scene; any version, if `None`.
    pub version: Option<SceneVersion>,
    pub estimator: String,
    pub sampler: String,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Samples per pixel of each half.
    pub spp: u32,
}

/// A half on disk, as it was when the experiment began.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct HalfFile {
    /// The film file.
    pub path: PathBuf,
    /// Its film's checksum.
    pub checksum: String,
}

impl Reference {
    pub(super) fn half(&self, lab: &Lab, half: u32) -> Result<Setup> {
        let setup = lab.prepare(self.half_settings(half))?;
        self.version.as_ref().map_or(Ok(()), |version| version.check(&setup.hash()))?;
        Ok(setup)
    }

    fn half_settings(&self, half: u32) -> Settings {
        Settings {
            scene: self.scene.clone(),
            spp: self.spp,
            spec: Spec {
                width: self.size[0],
                height: self.size[1],
                seed: reference_seed(half),
                estimator: self.estimator.clone(),
                sampler: self.sampler.clone(),
                ..Spec::default()
            },
            decomposition: "tiles:16x16".to_string(),
            strategy: "work-stealing".to_string(),
            threads: available_threads(),
            ..Settings::default()
        }
    }
}

/// The path at which a film with that key is cached.
pub(super) fn reference_path(folder: &Path, key: &FilmKey) -> PathBuf {
    let half = key.seed - REFERENCE_SEEDS;
    folder.join(format!(
        "{}-{}-{}-{}-{}x{}-{}spp-r{}-half{half}.film",
        key.scene, key.scene_hash, key.estimator, key.sampler, key.width, key.height, key.spp, key.revision
    ))
}

impl Reference {
    /// Refuses a reference that cannot be rendered, before any file is made.
    pub fn check(&self, lab: &Lab) -> Result<()> {
        if !is_deterministic(&self.sampler) {
            let problem = "draws different random numbers in each run, but a reference must be reproducible";
            let names: Vec<&str> =
                SAMPLERS.iter().filter(|entry| entry.deterministic).map(|entry| entry.name).collect();
            return Err(InputError::new("sampler", &self.sampler, problem).allowed(names.join(", ")).into());
        }
        self.half(lab, 0).map(|_| ())
    }

    /// The paths at which its two halves are cached.
    pub fn paths(&self, lab: &Lab, folder: &Path) -> Result<[PathBuf; 2]> {
        let path = |half| -> Result<PathBuf> { Ok(reference_path(folder, &self.half(lab, half)?.film_key())) };
        Ok([path(0)?, path(1)?])
    }

    /// Whether images of this cell are measured against this reference: a scene is the same under each of its names.
    pub(super) fn is_for(&self, cell: &Cell) -> bool {
        let spec = &cell.settings.spec;
        self.is_of(&cell.scene.hash) && self.size == [spec.width, spec.height]
    }

    /// Whether it is a reference of the scene with this hash.
    pub fn is_of(&self, scene_hash: &str) -> bool {
        self.version.as_ref().is_some_and(|version| version.hash == scene_hash)
    }

    /// Refuses names that no file can have, and a damaged film in the cache. Such a film is never replaced: it may be
    /// the user's only copy.
    pub fn check_cache(&self, lab: &Lab, folder: &Path) -> Result<()> {
        for path in self.paths(lab, folder)? {
            atomic_file::check_name(&path)?;
            if path.is_file() {
                read_film(&path)?;
            }
        }
        Ok(())
    }
}

/// The references that an experiment's cells need: one for each scene and size.
pub fn wanted_references(definition: &Definition, profile: Profile, cells: &[Cell]) -> Result<Vec<Reference>> {
    let Some((estimator, spp)) = definition.reference(profile)? else { return Ok(Vec::new()) };
    let mut wanted: Vec<Reference> = Vec::new();
    for cell in cells {
        let settings = &cell.settings;
        if !wanted.iter().any(|reference| reference.is_for(cell)) {
            wanted.push(Reference {
                scene: settings.scene.clone(),
                version: Some(cell.scene.clone()),
                estimator: estimator.clone(),
                sampler: "independent".to_string(),
                size: [settings.spec.width, settings.spec.height],
                spp,
            });
        }
    }
    Ok(wanted)
}
