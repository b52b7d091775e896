//! Images in memory.

/// A picture: linear radiance per colour channel (red, green, blue), row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    pub width: u32,
    pub height: u32,
    /// `width * height` pixels; pixel (x, y) is at `y * width + x`.
    pub pixels: Vec<[f64; 3]>,
}

impl Image {
    /// A black picture.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![[0.0; 3]; width as usize * height as usize] }
    }

    /// The pixel in column `x` of row `y`.
    pub fn pixel(&self, x: u32, y: u32) -> [f64; 3] {
        assert!(x < self.width, "column {x} of a picture {} wide", self.width);
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// The largest finite channel of all pixels; 0 without any above it.
    pub fn brightest(&self) -> f64 {
        brightest(self.pixels.iter().copied())
    }

    /// The mean of each channel; NaN for a picture without pixels.
    pub fn mean(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for pixel in &self.pixels {
            for (sum, value) in sum.iter_mut().zip(pixel) {
                *sum += value;
            }
        }
        sum.map(|sum| sum / self.pixels.len() as f64)
    }
}

/// The largest finite channel of some pixels; 0 without any above it.
pub(super) fn brightest(pixels: impl Iterator<Item = [f64; 3]>) -> f64 {
    pixels.flatten().filter(|value| value.is_finite()).fold(0.0, f64::max)
}
