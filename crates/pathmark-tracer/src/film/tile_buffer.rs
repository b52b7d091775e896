//! The sums of one piece's pixels. Only the kernel that renders the piece writes to them.

use super::image::brightest;
use super::whole::room;
use super::{Bounds, PixelSum};
use crate::error::Result;

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
