//! The film: the sums of all pixels of an image.

use super::image::brightest;
use super::{Image, PixelSum, TileBuffer, team};
use crate::digest::Fingerprint;
use crate::error::{Error, InputError, Result};
use std::io;

/// Largest width and height.
pub const LARGEST_SIDE: u32 = 1 << 16;
/// Largest number of pixels: their sums take 3.5 GiB in the film and as much in the pieces.
const LARGEST_AREA: u64 = 1 << 26;

/// Refuses sizes that no film can have, before memory is allocated.
pub fn check_size(width: u32, height: u32) -> Result<()> {
    let sides = (1..=LARGEST_SIDE).contains(&width) && (1..=LARGEST_SIDE).contains(&height);
    if sides && u64::from(width) * u64::from(height) <= LARGEST_AREA {
        return Ok(());
    }
    Err(InputError::new("size", format!("{width}x{height}"), "is not a valid image size")
        .allowed(format!("1x1 to {LARGEST_SIDE}x{LARGEST_SIDE}, at most {LARGEST_AREA} pixels"))
        .into())
}

/// Reserves memory for one value per pixel of a rectangle of this size. If the system refuses, this returns an error;
/// an allocation anywhere else would abort the program.
pub fn room<T>(width: u32, height: u32) -> Result<Vec<T>> {
    let mut room = Vec::new();
    room.try_reserve_exact(width as usize * height as usize).map_err(|e| {
        let what = format!("{width}x{height} pixels");
        Error::system("reserving memory for", what, io::Error::new(io::ErrorKind::OutOfMemory, e))
    })?;
    Ok(room)
}

/// Memory that is reserved during hours of rendering for the pictures and files made from the film at the end.
#[derive(Debug, Default)]
pub struct Reserve(Vec<[PixelSum; 2]>);

impl Reserve {
    /// Reserves enough for an image of this size, until it is dropped.
    pub fn new(width: u32, height: u32) -> Result<Self> {
        room(width, height).map(Self)
    }

    /// The number of pixels it is enough for.
    pub fn pixels(&self) -> usize {
        self.0.capacity()
    }
}

/// Sums of all pixels, row 0 at the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<PixelSum>,
}

impl Film {
    /// Creates an empty film.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![PixelSum::default(); width as usize * height as usize] }
    }

    /// Creates an empty film. Fails if the system lacks the memory.
    pub fn try_new(width: u32, height: u32) -> Result<Self> {
        let mut pixels = room(width, height)?;
        pixels.resize(width as usize * height as usize, PixelSum::default());
        Ok(Self { width, height, pixels })
    }

    /// Creates a film from these sums, row by row.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<PixelSum>) -> Self {
        Self { width, height, pixels }
    }

    pub fn width(&self) -> u32 {
        self.width
    }

    pub fn height(&self) -> u32 {
        self.height
    }

    /// The sums, row by row.
    pub fn pixels(&self) -> &[PixelSum] {
        &self.pixels
    }

    /// Copies the finished pixels of a rectangle to their place in the film.
    pub(super) fn place(&mut self, tile: &TileBuffer) {
        self.place_all(std::slice::from_ref(tile), 1);
    }

    /// Copies the pixels of many disjoint rectangles, with up to `threads` threads: each fills some rows of the film.
    pub(super) fn place_all(&mut self, tiles: &[TileBuffer], threads: usize) {
        let width = self.width as usize;
        let rows = self.height.div_ceil(threads.max(1) as u32).max(1);
        let bands = (0..self.height).step_by(rows as usize).zip(self.pixels.chunks_mut(rows as usize * width));
        let fill = |(first, band): (u32, &mut [PixelSum])| {
            for tile in tiles {
                let bounds = tile.bounds();
                for (y, row) in
                    (bounds.y0..bounds.y1).zip(tile.rows()).filter(|(y, _)| (first..first + rows).contains(y))
                {
                    let start = (y - first) as usize * width + bounds.x0 as usize;
                    band[start..start + row.len()].copy_from_slice(row);
                }
            }
        };
        team::for_each(bands, threads, fill);
    }

    /// Copies the pixels for which `owns` is true, by column and row, from another film of the same size.
    pub fn take(&mut self, other: &Self, owns: impl Fn(u32, u32) -> bool) {
        let places = (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y)));
        for ((pixel, found), (x, y)) in self.pixels.iter_mut().zip(&other.pixels).zip(places) {
            if owns(x, y) {
                *pixel = *found;
            }
        }
    }

    /// The sum of two ranges of samples of the same image; `self` is the earlier one.
    #[must_use]
    pub fn plus(mut self, later: &Self) -> Self {
        for (pixel, part) in self.pixels.iter_mut().zip(&later.pixels) {
            *pixel = pixel.plus(part);
        }
        self
    }

    /// The estimate of each pixel's radiance.
    pub fn image(&self) -> Image {
        let mut image = Image::new(self.width, self.height);
        for (out, pixel) in image.pixels.iter_mut().zip(&self.pixels) {
            *out = pixel.mean();
        }
        image
    }

    /// [`Image::brightest`] of its image.
    pub fn brightest(&self) -> f64 {
        brightest(self.pixels.iter().map(PixelSum::mean))
    }

    /// SHA-256 over the size and the bits of every sum, shortened to 16 hexadecimal digits. The sign of zero is
    /// ignored.
    pub fn checksum(&self) -> String {
        let mut hash = Fingerprint::default();
        hash.update(&self.width.to_le_bytes());
        hash.update(&self.height.to_le_bytes());
        for pixel in &self.pixels {
            hash.update(&pixel.count.to_le_bytes());
            for value in pixel.sum.iter().chain(&pixel.square) {
                hash.update(&(value + 0.0).to_bits().to_le_bytes());
            }
        }
        hash.finish()
    }
}
