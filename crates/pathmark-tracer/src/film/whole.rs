//! The whole image as sums.

use super::{Image, PixelSum, TileBuffer};
use crate::digest::Fingerprint;
use crate::error::{Error, InputError, Result};
use bytemuck::try_zeroed_vec;
use std::io;
use std::sync::{Mutex, PoisonError};
use std::thread::{Builder, scope};

/// Largest width and height.
pub const LARGEST_SIDE: u32 = 1 << 16;
/// Largest number of pixels: their sums take 3.5 GiB.
const LARGEST_AREA: u64 = 1 << 26;

/// Refuses sizes that no film can have, before anything is allocated.
pub fn check_size(width: u32, height: u32) -> Result<()> {
    let sides = (1..=LARGEST_SIDE).contains(&width) && (1..=LARGEST_SIDE).contains(&height);
    if sides && u64::from(width) * u64::from(height) <= LARGEST_AREA {
        return Ok(());
    }
    Err(InputError::new("size", format!("{width}x{height}"), "is not a size that an image can have")
        .allowed(format!("1x1 to {LARGEST_SIDE}x{LARGEST_SIDE}, at most {LARGEST_AREA} pixels"))
        .into())
}

/// Room for a value per pixel of a rectangle of this size. Where the system refuses it, that is an error here; an allocation anywhere else would
/// end the program.
pub fn room<T>(width: u32, height: u32) -> Result<Vec<T>> {
    let mut room = Vec::new();
    room.try_reserve_exact(width as usize * height as usize)
        .map_err(|e| refused(width, height, io::Error::new(io::ErrorKind::OutOfMemory, e)))?;
    Ok(room)
}

fn refused(width: u32, height: u32, error: io::Error) -> Error {
    Error::system("reserving memory for", format!("{width}x{height} pixels"), error)
}

/// Memory that is kept free during hours of rendering for what is made of a film in the end: pictures, and their files.
#[derive(Debug, Default)]
pub struct Reserve(Vec<[PixelSum; 2]>);

impl Reserve {
    /// As much as is needed for an image of this size, until it is dropped.
    pub fn new(width: u32, height: u32) -> Result<Self> {
        room(width, height).map(Self)
    }

    /// How many pixels it is for.
    pub fn pixels(&self) -> usize {
        self.0.capacity()
    }
}

/// Films of up to so many pixels are touched when they are made, so that the time to put them together is not the time that the system takes to give
/// memory. A larger one would be a second copy of what its pieces hold for as long as they are rendered.
const MOST_TOUCHED: usize = 1 << 22;

/// Pixels that are put together before the memory of their pieces is given back.
const AT_A_TIME: usize = 1 << 20;

/// Puts what rectangles have of some rows, from the `first` on, where it belongs, by up to so many threads: each has some of the rows.
fn place_in(pixels: &mut [PixelSum], first: u32, width: usize, tiles: &[TileBuffer], threads: usize) {
    let height = pixels.len() / width.max(1);
    let rows = height.div_ceil(threads.max(1)).max(1);
    let bands = (first..).step_by(rows).zip(pixels.chunks_mut((rows * width).max(1)));
    let fill = |(first, band): (u32, &mut [PixelSum])| {
        let end = first + (band.len() / width) as u32;
        for tile in tiles.iter().filter(|tile| tile.bounds().y0 < end && first < tile.bounds().y1) {
            let bounds = tile.bounds();
            for (y, row) in (bounds.y0..bounds.y1).zip(tile.rows()).filter(|(y, _)| (first..end).contains(y)) {
                let start = (y - first) as usize * width + bounds.x0 as usize;
                band[start..start + row.len()].copy_from_slice(row);
            }
        }
    };
    if threads < 2 {
        return bands.for_each(fill);
    }
    let waiting = Mutex::new(bands);
    let work = || {
        loop {
            let next = waiting.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some(band) = next else { return };
            fill(band);
        }
    };
    scope(|scope| {
        // Where the system gives no thread, this one does what is left.
        for _ in 1..threads {
            if Builder::new().spawn_scoped(scope, work).is_err() {
                break;
            }
        }
        work();
    });
}

/// Sums of all pixels, row 0 at the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<PixelSum>,
}

impl Film {
    /// An empty film.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![PixelSum::default(); width as usize * height as usize] }
    }

    /// An empty film, if the system has the memory. That of a large one is not touched before there is something to put into it.
    pub fn try_new(width: u32, height: u32) -> Result<Self> {
        let area = width as usize * height as usize;
        let pixels = if area <= MOST_TOUCHED {
            let mut pixels = room(width, height)?;
            pixels.resize(area, PixelSum::default());
            pixels
        } else {
            try_zeroed_vec(area).map_err(|()| refused(width, height, io::ErrorKind::OutOfMemory.into()))?
        };
        Ok(Self { width, height, pixels })
    }

    /// A film of these sums, row by row.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<PixelSum>) -> Self {
        Self { width, height, pixels }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The sums, row by row.
    pub fn pixels(&self) -> &[PixelSum] {
        &self.pixels
    }

    /// Puts the finished pixels of a rectangle where they belong.
    pub(super) fn place(&mut self, tile: &TileBuffer) {
        let bounds = tile.bounds();
        for (y, row) in (bounds.y0..bounds.y1).zip(tile.rows()) {
            let start = y as usize * self.width as usize + bounds.x0 as usize;
            self.pixels[start..start + row.len()].copy_from_slice(row);
        }
    }

    /// Touches the memory of a large film now, because it will be put together where somebody waits.
    pub(super) fn touch(&mut self) {
        if self.pixels.len() > MOST_TOUCHED {
            self.pixels.fill(PixelSum::default());
        }
    }

    /// Likewise, the pixels of many rectangles, none of which overlap, by up to so many threads. From the last row up, and what has been placed is let
    /// go: the memory of a large film is touched here for the first time. If that of the last rectangles was taken last, the C library gives it back to
    /// the system, and both together never take much more than one of them.
    pub(super) fn place_all(&mut self, mut tiles: Vec<TileBuffer>, threads: usize) {
        let width = self.width as usize;
        let rows = (AT_A_TIME / width.max(1)).clamp(1, self.height.max(1) as usize) as u32;
        let mut end = self.height;
        while end > 0 {
            let first = end.saturating_sub(rows);
            let band = &mut self.pixels[first as usize * width..end as usize * width];
            place_in(band, first, width, &tiles, threads);
            tiles.retain_mut(|tile| tile.keep_above(first));
            end = first;
        }
    }

    /// Takes the pixels that `owns` tells of, by column and row, from another film of the same size.
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

    /// SHA-256 over size and the bits of every sum, shortened to 16 hexadecimal digits. The sign of zero does not count.
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
