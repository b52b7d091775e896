//! Files of sums in full precision: the common layout of film files and checkpoints. Such a file cannot be mistaken for
//! another kind, and is refused if a byte is missing.
//!
//! Layout: a line that names the kind, a line of JSON, 52 bytes for each pixel (three sums, three sums of squares as
//! little-endian f64, the count as u32) of one image after the other, and the SHA-256 of everything before it.

use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::film::{Film, PixelSum, check_size, room};
use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Take};
use std::path::Path;

const PIXEL_BYTES: usize = 52;
const DIGEST_BYTES: usize = 32;
/// In bytes.
const LONGEST_MAGIC: usize = 64;
/// First words of checkpoints and of parts of images, whatever their version.
const CHECKPOINT: &[u8] = b"pathmark checkpoint";
/// In bytes; a header holds only names and numbers.
const LONGEST_HEADER: usize = 1 << 16;

pub struct SumFile {
    /// Its first line, without the newline: a name and the layout's version.
    pub magic: &'static str,
    pub field: &'static str,
}

impl SumFile {
    fn broken(&self, path: &Path, problem: &str) -> Error {
        InputError::new(self.field, path.display().to_string(), problem).into()
    }

    /// Writes a header and images, whole or not at all. Nothing is copied, since there may be no memory left.
    pub fn write(&self, path: &Path, header: &impl Serialize, films: &[&Film]) -> Result<()> {
        let header = serde_json::to_string(header).map_err(|e| Error::system("writing", path, e.into()))?;
        atomic_file::write(path, |out| {
            let mut digest = Sha256::new();
            let mut put = |bytes: &[u8]| {
                digest.update(bytes);
                out.write_all(bytes)
            };
            put(format!("{}\n{header}\n", self.magic).as_bytes())?;
            for pixel in films.iter().flat_map(|film| film.pixels()) {
                put(&bytes_of(pixel))?;
            }
            out.write_all(&digest.finalize())
        })
    }

    /// Reads a header, and the images that it describes. `shape` returns their common width and height, and their
    /// number. Allocates no more memory than the file is long.
    pub fn read<H: DeserializeOwned>(
        &self,
        path: &Path,
        shape: impl FnOnce(&H) -> (u32, u32, usize),
    ) -> Result<(H, Vec<Film>)> {
        let (mut body, line) = self.begin(path)?;
        let truncated = || self.truncated(path);
        let unreadable = |e: io::Error| self.unreadable(path, e);
        let header: std::result::Result<H, _> = serde_json::from_slice(&line);
        let films = match &header {
            // Images of a damaged header are neither read nor allocated.
            Err(_) => Vec::new(),
            Ok(header) => {
                let (width, height, images) = shape(header);
                self.check_length(path, &body, (width, height, images))?;
                (0..images).map(|_| body.film(width, height, unreadable)).collect::<Result<_>>()?
            }
        };
        if !body.ends_whole().map_err(unreadable)? {
            return Err(truncated());
        }
        Ok((header.map_err(|e| self.no_header(path, &e))?, films))
    }

    /// Reads only a header, and checks that the file is as long as the images that it describes.
    pub fn header<H: DeserializeOwned>(&self, path: &Path, shape: impl FnOnce(&H) -> (u32, u32, usize)) -> Result<H> {
        let (body, line) = self.begin(path)?;
        let header = serde_json::from_slice(&line).map_err(|e| self.no_header(path, &e))?;
        self.check_length(path, &body, shape(&header))?;
        Ok(header)
    }

    /// Refuses a file whose rest after the header does not have the length of so many images of a width and height.
    fn check_length(&self, path: &Path, body: &Body, (width, height, images): (u32, u32, usize)) -> Result<()> {
        let in_file = |input: InputError| input.in_file(path.display().to_string(), None).into();
        check_size(width, height).map_err(|error| error.placed(in_file))?;
        let size = (u64::from(width) * u64::from(height) * PIXEL_BYTES as u64).checked_mul(images as u64);
        if size == Some(body.file.limit()) {
            return Ok(());
        }
        Err(self.broken(path, "does not contain as many pixels as its header states"))
    }

    fn begin(&self, path: &Path) -> Result<(Body, Vec<u8>)> {
        let data = fs::metadata(path).map_err(|e| match e.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => self.broken(path, "there is no such file"),
            _ => Error::system("reading", path, e),
        })?;
        // Checked before the file is opened: to open a pipe would wait for a writer.
        if !data.is_file() {
            return Err(self.broken(path, "is not a regular file"));
        }
        let file = File::open(path).map_err(|e| Error::system("reading", path, e))?;
        let Some(length) = data.len().checked_sub(DIGEST_BYTES as u64) else {
            return Err(self.broken(path, &format!("is too short to be a {} file", self.field)));
        };
        let mut body = Body { file: BufReader::new(file).take(length), digest: Sha256::new() };
        let unreadable = |e: io::Error| self.unreadable(path, e);
        let (first, magic) = (body.line(LONGEST_MAGIC).map_err(unreadable)?, self.magic.as_bytes());
        if first != magic {
            let is_part = first.starts_with(CHECKPOINT) && !magic.starts_with(CHECKPOINT);
            let reason = if is_part {
                "it is a checkpoint or a part of an image, and `pathmark merge` makes images from parts".to_string()
            } else {
                format!("its first line is not \"{}\"", self.magic)
            };
            return Err(self.broken(path, &format!("is not a {} file of this version: {reason}", self.field)));
        }
        let line = body.line(LONGEST_HEADER).map_err(unreadable)?;
        Ok((body, line))
    }

    fn truncated(&self, path: &Path) -> Error {
        self.broken(path, "is truncated or damaged: its checksum does not match")
    }

    fn no_header(&self, path: &Path, why: &serde_json::Error) -> Error {
        self.broken(path, &format!("has a header that cannot be read: {why}"))
    }

    fn unreadable(&self, path: &Path, e: io::Error) -> Error {
        match e.kind() {
            ErrorKind::UnexpectedEof => self.truncated(path),
            _ => Error::system("reading", path, e),
        }
    }
}

/// The part of a file that its checksum covers, with the digest of the bytes read so far.
struct Body {
    file: Take<BufReader<File>>,
    digest: Sha256,
}

impl Body {
    fn bytes(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self.file.read_exact(bytes)?;
        self.digest.update(bytes);
        Ok(())
    }

    /// Reads a line without its newline; empty if the line has more than `most` bytes.
    fn line(&mut self, most: usize) -> io::Result<Vec<u8>> {
        let mut line = Vec::new();
        self.file.by_ref().take(most as u64 + 1).read_until(b'\n', &mut line)?;
        self.digest.update(&line);
        if line.pop() == Some(b'\n') { Ok(line) } else { Ok(Vec::new()) }
    }

    fn film(&mut self, width: u32, height: u32, unreadable: impl Fn(io::Error) -> Error) -> Result<Film> {
        let mut pixels = room(width, height)?;
        for _ in 0..u64::from(width) * u64::from(height) {
            let mut bytes = [0; PIXEL_BYTES];
            self.bytes(&mut bytes).map_err(&unreadable)?;
            pixels.push(pixel(&bytes));
        }
        Ok(Film::from_pixels(width, height, pixels))
    }

    fn ends_whole(mut self) -> io::Result<bool> {
        let mut chunk = [0; 4096];
        loop {
            let count = self.file.read(&mut chunk)?;
            if count == 0 {
                break;
            }
            self.digest.update(&chunk[..count]);
        }
        let mut found = [0; DIGEST_BYTES];
        self.file.into_inner().read_exact(&mut found)?;
        Ok(self.digest.finalize().as_slice() == found)
    }
}

fn bytes_of(pixel: &PixelSum) -> [u8; PIXEL_BYTES] {
    let mut bytes = [0; PIXEL_BYTES];
    for (place, value) in bytes.chunks_exact_mut(8).zip(pixel.sum.iter().chain(&pixel.square)) {
        place.copy_from_slice(&value.to_le_bytes());
    }
    bytes[48..].copy_from_slice(&pixel.count.to_le_bytes());
    bytes
}

fn pixel(bytes: &[u8; PIXEL_BYTES]) -> PixelSum {
    let number = |at: usize| f64::from_le_bytes(std::array::from_fn(|k| bytes[at + k]));
    PixelSum {
        sum: std::array::from_fn(|k| number(8 * k)),
        square: std::array::from_fn(|k| number(24 + 8 * k)),
        count: u32::from_le_bytes(std::array::from_fn(|k| bytes[48 + k])),
    }
}
