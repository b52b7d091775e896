//! The film file: sums in full precision, for references. It cannot be mistaken for another film, nor read if a byte is missing.
//!
//! Layout: the line `pathmark film 1`, a line of JSON (the [`FilmKey`]), 52 bytes for each pixel (three sums, three sums of squares as
//! little-endian f64, the count as u32), and the SHA-256 of all that.

use super::{Film, PixelSum, check_size};
use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::Path;

const MAGIC: &str = "pathmark film 1\n";
const PIXEL_BYTES: usize = 52;
const DIGEST_BYTES: usize = 32;

/// What a film is of: two films with the same key hold the same bits.
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
    /// Where paths are cut, if they are.
    #[serde(default)]
    pub max_depth: Option<u16>,
    /// How chance ends paths, if not by the estimator's own rule.
    #[serde(default)]
    pub roulette: Option<String>,
    /// Revision of the arithmetic: films of another one are rendered anew.
    pub revision: u32,
}

/// Writes the film, whole or not at all.
pub fn write_film(path: &Path, key: &FilmKey, film: &Film) -> Result<()> {
    let mut bytes = Vec::with_capacity(film.pixels().len() * PIXEL_BYTES + 512);
    bytes.extend_from_slice(MAGIC.as_bytes());
    bytes.extend_from_slice(serde_json::to_string(key).unwrap_or_default().as_bytes());
    bytes.push(b'\n');
    for pixel in film.pixels() {
        for value in pixel.sum.iter().chain(&pixel.square) {
            bytes.extend_from_slice(&value.to_le_bytes());
        }
        bytes.extend_from_slice(&pixel.count.to_le_bytes());
    }
    let digest = Sha256::digest(&bytes);
    bytes.extend_from_slice(&digest);
    atomic_file::write(path, |out| out.write_all(&bytes))
}

/// Reads a film and what it is of.
pub fn read_film(path: &Path) -> Result<(FilmKey, Film)> {
    let bytes = std::fs::read(path).map_err(|e| Error::system("reading", path, e))?;
    let broken = |problem: &str| Error::from(InputError::new("film", path.display().to_string(), problem));
    let Some((body, digest)) = bytes.len().checked_sub(DIGEST_BYTES).map(|at| bytes.split_at(at)) else {
        return Err(broken("is too short to be a film file"));
    };
    let Some(rest) = body.strip_prefix(MAGIC.as_bytes()) else {
        return Err(broken("is not a film file of version 1"));
    };
    if Sha256::digest(body).as_slice() != digest {
        return Err(broken("is truncated or damaged: its checksum does not hold"));
    }
    let end = rest.iter().position(|byte| *byte == b'\n').ok_or_else(|| broken("has no header"))?;
    let key: FilmKey =
        serde_json::from_slice(&rest[..end]).map_err(|e| broken(&format!("has a header that cannot be read: {e}")))?;
    check_size(key.width, key.height)?;
    let data = &rest[end + 1..];
    if data.len() != key.width as usize * key.height as usize * PIXEL_BYTES {
        return Err(broken("does not have as many pixels as its header says"));
    }
    let number = |bytes: &[u8]| f64::from_le_bytes(std::array::from_fn(|k| bytes[k]));
    let pixels = data.chunks_exact(PIXEL_BYTES).map(|pixel| PixelSum {
        sum: std::array::from_fn(|k| number(&pixel[8 * k..])),
        square: std::array::from_fn(|k| number(&pixel[24 + 8 * k..])),
        count: u32::from_le_bytes(std::array::from_fn(|k| pixel[48 + k])),
    });
    let film = Film::from_pixels(key.width, key.height, pixels.collect());
    Ok((key, film))
}
