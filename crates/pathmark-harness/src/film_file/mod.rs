//! Film files: sums in full precision, for references. The layout is [`SumFile`], with the [`FilmKey`] as its JSON.

mod sum_file;

use crate::error::Result;
use crate::film::Film;
use crate::simd::Precision;
use serde::{Deserialize, Serialize};
use std::path::Path;
pub use sum_file::SumFile;

const FILE: SumFile = SumFile { magic: "pathmark film 1", field: "film" };

/// The identity of a film: two films with the same key hold the same bits.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilmKey {
    /// Name of the scene.
    pub scene: String,
    /// Hash of the scene's definition.
    pub scene_hash: String,
    /// Estimator.
    pub estimator: String,
    /// Sampler.
    pub sampler: String,
    /// Seed; at least [`crate::sampling::REFERENCE_SEEDS`] for references.
    pub seed: u64,
    /// Samples per pixel.
    pub spp: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Depth at which paths are cut, if they are.
    #[serde(default)]
    pub max_depth: Option<u16>,
    /// Camera rays per sample, if there are several.
    #[serde(default)]
    pub camera_rays: Option<u16>,
    /// Russian roulette rule, including the estimator's own rule, which films of revision 1 omit.
    #[serde(default)]
    pub roulette: Option<String>,
    /// The clamp, if there is one; older files have no entry.
    #[serde(default)]
    pub clamp: Option<String>,
    /// The pixel filter, if it is not the camera's own.
    #[serde(default)]
    pub filter: Option<String>,
    /// Distance below which no hit counts, if there is one.
    #[serde(default)]
    pub epsilon: Option<String>,
    /// Floating-point format of the paths; older files have only one.
    #[serde(default = "double")]
    pub precision: String,
    /// Whether the number of samples of a tile depends on its noise; `spp` is then the mean.
    #[serde(default)]
    pub adaptive: bool,
    /// Revision of the arithmetic: films of another revision are rendered again.
    pub revision: u32,
}

fn double() -> String {
    Precision::F64.name().to_string()
}

/// Writes the film, whole or not at all.
pub fn write_film(path: &Path, key: &FilmKey, film: &Film) -> Result<()> {
    FILE.write(path, key, &[film])
}

/// Reads a film and its key.
pub fn read_film(path: &Path) -> Result<(FilmKey, Film)> {
    let (key, films) = FILE.read(path, |key: &FilmKey| (key.width, key.height, 1))?;
    let film = films.into_iter().next().unwrap_or_else(|| Film::new(key.width, key.height));
    Ok((key, film))
}
