//! Sums on disk in full precision: what film files and checkpoints have in common. Such a file cannot be mistaken for another kind, nor
//! read if a byte is missing.
//!
//! Layout: a line that names the kind, a line of JSON, 52 bytes for each pixel (three sums, three sums of squares as little-endian f64,
//! the count as u32) of one image after the other, and the SHA-256 of all that.

use super::{Film, PixelSum, check_size};
use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};
use std::path::Path;

const PIXEL_BYTES: usize = 52;
const DIGEST_BYTES: usize = 32;

/// A kind of file.
pub struct SumFile {
    /// Its first line, without the end: a name and the layout's version.
    pub magic: &'static str,
    /// The field that errors name.
    pub field: &'static str,
}

impl SumFile {
    fn broken(&self, path: &Path, problem: &str) -> Error {
        InputError::new(self.field, path.display().to_string(), problem).into()
    }

    /// Writes a header and images, whole or not at all.
    pub fn write(&self, path: &Path, header: &impl Serialize, films: &[&Film]) -> Result<()> {
        let pixels: usize = films.iter().map(|film| film.pixels().len()).sum();
        let mut bytes = Vec::with_capacity(pixels * PIXEL_BYTES + 1024);
        bytes.extend_from_slice(self.magic.as_bytes());
        bytes.push(b'\n');
        bytes.extend_from_slice(serde_json::to_string(header).unwrap_or_default().as_bytes());
        bytes.push(b'\n');
        for pixel in films.iter().flat_map(|film| film.pixels()) {
            for value in pixel.sum.iter().chain(&pixel.square) {
                bytes.extend_from_slice(&value.to_le_bytes());
            }
            bytes.extend_from_slice(&pixel.count.to_le_bytes());
        }
        let digest = Sha256::digest(&bytes);
        bytes.extend_from_slice(&digest);
        atomic_file::write(path, |out| out.write_all(&bytes))
    }

    /// Reads a header, and as many images of one size as `shape` says by it: width, height and number.
    pub fn read<H: DeserializeOwned>(
        &self,
        path: &Path,
        shape: impl FnOnce(&H) -> (u32, u32, usize),
    ) -> Result<(H, Vec<Film>)> {
        let bytes = std::fs::read(path).map_err(|e| Error::system("reading", path, e))?;
        let Some((body, digest)) = bytes.len().checked_sub(DIGEST_BYTES).map(|at| bytes.split_at(at)) else {
            return Err(self.broken(path, &format!("is too short to be a {} file", self.field)));
        };
        let Some(rest) = body.strip_prefix(self.magic.as_bytes()).and_then(|rest| rest.strip_prefix(b"\n")) else {
            return Err(self.broken(path, &format!("does not begin with the line \"{}\"", self.magic)));
        };
        if Sha256::digest(body).as_slice() != digest {
            return Err(self.broken(path, "is truncated or damaged: its checksum does not hold"));
        }
        let end = rest.iter().position(|byte| *byte == b'\n').ok_or_else(|| self.broken(path, "has no header"))?;
        let header: H = serde_json::from_slice(&rest[..end])
            .map_err(|e| self.broken(path, &format!("has a header that cannot be read: {e}")))?;
        let (width, height, images) = shape(&header);
        check_size(width, height)?;
        let area = width as usize * height as usize;
        let data = &rest[end + 1..];
        if area.checked_mul(PIXEL_BYTES).and_then(|size| size.checked_mul(images)) != Some(data.len()) {
            return Err(self.broken(path, "does not have as many pixels as its header says"));
        }
        let image =
            |bytes: &[u8]| Film::from_pixels(width, height, bytes.chunks_exact(PIXEL_BYTES).map(pixel).collect());
        let films = data.chunks_exact(area * PIXEL_BYTES).map(image).collect();
        Ok((header, films))
    }
}

fn pixel(bytes: &[u8]) -> PixelSum {
    let number = |at: usize| f64::from_le_bytes(std::array::from_fn(|k| bytes[at + k]));
    PixelSum {
        sum: std::array::from_fn(|k| number(8 * k)),
        square: std::array::from_fn(|k| number(24 + 8 * k)),
        count: u32::from_le_bytes(std::array::from_fn(|k| bytes[48 + k])),
    }
}
