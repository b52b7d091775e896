//! Picture files: one module per format, one entry each in [`FORMATS`].
//!
//! In memory a picture is linear radiance in f64, row 0 at the top. `exr`, `pfm` and `hdr` store linear values; `png`,
//! `ppm` and `bmp` store display values, through [`tone_map`], and lose values outside [0, 1].
//!
//! A file that cannot be read is an [`InputError`] that names it. No content of a file can make a reader panic, or
//! allocate more memory than the file's own length justifies. Pixels that a format cannot hold are an [`Error::Check`].

#[cfg(feature = "pictures")]
mod bmp;
#[cfg(feature = "pictures")]
mod codec;
#[cfg(feature = "pictures")]
mod exr;
#[cfg(feature = "pictures")]
mod hdr;
mod pfm;
#[cfg(feature = "pictures")]
mod png;
#[cfg(feature = "pictures")]
mod ppm;
#[cfg(all(test, feature = "pictures"))]
mod robustness_tests;
pub mod tone_map;

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use crate::atomic_file;
use crate::error::{Error, InputError, Result};
pub use crate::film::Image;
pub use tone_map::auto_exposed;

/// A decoded value, or the problem of a file's bytes; the caller adds the file's name.
type Decoded<T> = std::result::Result<T, String>;

const MAX_SIDE: u64 = 1 << 16;
/// The most pixels: 6 GiB in memory.
const MAX_PIXELS: u64 = 1 << 28;
/// The longest file, in bytes: more than the largest picture takes in the least compact format (text with 16 bits per
/// channel).
const MAX_FILE_LENGTH: u64 = 20 * MAX_PIXELS;

/// A file format, recognised by the extension of the file's name.
#[derive(Debug)]
pub struct Format {
    pub name: &'static str,
    pub about: &'static str,
    /// Whether values are linear radiance; otherwise display values in 8 bits.
    pub linear: bool,
    forbidden_width: Option<u32>,
    decode: fn(&[u8]) -> Decoded<Image>,
    /// Encodes a picture as the bytes of a file; its number of pixels must match its size.
    encode: fn(&Image, &[Note]) -> Result<Vec<u8>>,
    /// The notes in a file's bytes, as far as they can be read.
    notes: fn(&[u8]) -> Vec<(String, String)>,
}

impl Format {
    /// A format without notes, for pictures of any width.
    const fn new(
        name: &'static str,
        about: &'static str,
        linear: bool,
        decode: fn(&[u8]) -> Decoded<Image>,
        encode: fn(&Image, &[Note]) -> Result<Vec<u8>>,
    ) -> Self {
        Self { name, about, linear, forbidden_width: None, decode, encode, notes: |_| Vec::new() }
    }
}

/// A text stored with the pixels: its name, of letters, and the text. `png` and `exr` keep it, the others drop it.
pub type Note = (&'static str, String);

/// Every format, for reading and for writing.
#[cfg(feature = "pictures")]
pub const FORMATS: &[Format] = &[png::FORMAT, exr::FORMAT, hdr::FORMAT, pfm::FORMAT, ppm::FORMAT, bmp::FORMAT];
/// Every format that needs no other library, for reading and for writing.
#[cfg(not(feature = "pictures"))]
pub const FORMATS: &[Format] = &[pfm::FORMAT];

/// Returns the format for the extension of `path`, in upper or lower case. Call it before anything is rendered.
pub fn check_format(path: &Path) -> Result<&'static Format> {
    let extension = path.extension().unwrap_or_default();
    FORMATS.iter().find(|format| extension.eq_ignore_ascii_case(format.name)).ok_or_else(|| {
        let names: Vec<_> = FORMATS.iter().map(|format| format.name).collect();
        let problem = "the extension does not name a picture format";
        InputError::new("image", path.display().to_string(), problem).allowed(names.join(", ")).into()
    })
}

/// Like [`check_format`], and also checks that the format accepts pictures of this size.
pub fn check_picture(path: &Path, width: u32, height: u32) -> Result<&'static Format> {
    let format = check_format(path)?;
    let size = format!("{width}x{height}");
    check_size(u64::from(width), u64::from(height)).map_err(|e| InputError::new("size", &size, e))?;
    if format.forbidden_width == Some(width) {
        let problem = format!("is not a valid size for a {} picture", format.name);
        return Err(InputError::new("size", size, problem).allowed(format!("any width except {width}")).into());
    }
    Ok(format)
}

pub fn read(path: &Path) -> Result<Image> {
    let (format, bytes) = bytes_of(path)?;
    decoded(path, format, &bytes)
}

pub fn read_with_notes(path: &Path) -> Result<(Image, Vec<(String, String)>)> {
    let (format, bytes) = bytes_of(path)?;
    Ok((decoded(path, format, &bytes)?, (format.notes)(&bytes)))
}

fn refused(path: &Path, problem: String) -> Error {
    InputError::new("image", path.display().to_string(), problem).into()
}

fn decoded(path: &Path, format: &Format, bytes: &[u8]) -> Result<Image> {
    let unreadable = |problem| refused(path, format!("not a readable {} picture: {problem}", format.name));
    (format.decode)(bytes).map_err(unreadable)
}

fn bytes_of(path: &Path) -> Result<(&'static Format, Vec<u8>)> {
    let format = check_format(path)?;
    let metadata = fs::metadata(path).map_err(|e| match e.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => refused(path, "there is no such file".into()),
        _ => Error::system("reading", path, e),
    })?;
    if !metadata.is_file() {
        return Err(refused(path, "is not a regular file".into()));
    }
    if metadata.len() > MAX_FILE_LENGTH {
        return Err(refused(path, format!("{} bytes are too many for a picture", metadata.len())));
    }
    Ok((format, fs::read(path).map_err(|e| Error::system("reading", path, e))?))
}

pub fn write(path: &Path, image: &Image) -> Result<()> {
    write_with_notes(path, image, &[])
}

/// Writes `image` to `path`, whole or not at all, with `notes` where the format keeps them.
pub fn write_with_notes(path: &Path, image: &Image, notes: &[Note]) -> Result<()> {
    let (width, height, count) = (image.width, image.height, image.pixels.len());
    assert_eq!(width as usize * height as usize, count, "a picture of {width} x {height} holds {count} pixels");
    let format = check_picture(path, width, height)?;
    let bytes = (format.encode)(image, notes)?;
    atomic_file::write(path, |out| out.write_all(&bytes))
}

/// Checks that Pathmark reads and writes pictures of this size.
fn check_size(width: u64, height: u64) -> Decoded<()> {
    if width == 0 || height == 0 {
        Err(format!("a picture of {width} x {height} pixels is empty"))
    } else if width > MAX_SIDE || height > MAX_SIDE || width * height > MAX_PIXELS {
        Err(format!("{width} x {height} pixels are more than {MAX_SIDE} per side or {MAX_PIXELS} in all"))
    } else {
        Ok(())
    }
}

/// Converts all channel values to f32, the precision of the linear formats. NaN and infinity remain, so that a picture
/// can show where they are; a finite value that only f64 can hold is refused.
fn to_f32(image: &Image) -> Result<Vec<f32>> {
    let too_large = |value: &f64| value.is_finite() && (*value as f32).is_infinite();
    match image.pixels.iter().position(|pixel| pixel.iter().any(too_large)) {
        Some(index) => Err(tone_map::bad_pixel(image, index, "is too large for f32")),
        None => Ok(image.pixels.iter().flatten().map(|&value| value as f32).collect()),
    }
}
