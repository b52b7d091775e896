//! The sums of one piece's pixels. Only the kernel that renders the piece writes to them.

use super::image::brightest;
use super::whole::room;
use super::{Bounds, PixelSum, team};
use crate::error::Result;
use std::iter::repeat_with;

/// Buffers that one thread makes at a time: a few megabytes of the usual tiles.
const MADE_AT_ONCE: usize = 64;

/// The pixels of a rectangle, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct TileBuffer {
    bounds: Bounds,
    pixels: Vec<PixelSum>,
}

impl TileBuffer {
    /// Creates an empty buffer for the rectangle.
    pub fn new(bounds: Bounds) -> Self {
        Self { bounds, pixels: vec![PixelSum::default(); bounds.area()] }
    }

    /// Creates an empty buffer for the rectangle. Fails if the system lacks the memory.
    pub fn try_new(bounds: Bounds) -> Result<Self> {
        let mut pixels = room(bounds.width(), bounds.height())?;
        pixels.resize(bounds.area(), PixelSum::default());
        Ok(Self { bounds, pixels })
    }

    /// Empty buffers for some rectangles, made and touched by up to `threads` threads. Fails if the system lacks the
    /// memory.
    pub fn all(rectangles: &[Bounds], threads: usize) -> Result<Vec<Self>> {
        let groups = rectangles.chunks(MADE_AT_ONCE);
        let mut made: Vec<Result<Vec<Self>>> = repeat_with(|| Ok(Vec::new())).take(groups.len()).collect();
        let make = |(group, made): (&[Bounds], &mut Result<Vec<Self>>)| {
            *made = group.iter().map(|bounds| Self::try_new(*bounds)).collect();
        };
        let threads = threads.min(groups.len());
        team::for_each(groups.zip(&mut made), threads, make);
        let mut all = Vec::with_capacity(rectangles.len());
        for made in made {
            all.extend(made?);
        }
        Ok(all)
    }

    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The pixels of image row `y`, from the rectangle's first column on.
    #[inline]
    pub fn row_mut(&mut self, y: u32) -> &mut [PixelSum] {
        let width = self.bounds.width() as usize;
        let start = (y - self.bounds.y0) as usize * width;
        &mut self.pixels[start..start + width]
    }

    /// The sum of two ranges of samples of the same pixels; `self` is the earlier one.
    #[must_use]
    pub fn plus(mut self, later: &Self) -> Self {
        for (pixel, part) in self.pixels.iter_mut().zip(&later.pixels) {
            *pixel = pixel.plus(part);
        }
        self
    }

    /// The largest channel of its pixels, as in [`super::Image::brightest`].
    pub fn brightest(&self) -> f64 {
        brightest(self.pixels.iter().map(PixelSum::mean))
    }

    /// The rows, from the top.
    pub fn rows(&self) -> impl Iterator<Item = &[PixelSum]> {
        self.pixels.chunks_exact(self.bounds.width() as usize)
    }
}
