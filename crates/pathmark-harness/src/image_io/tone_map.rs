//! Tone mapping from linear radiance to display values, as in smallpt: clamp to [0, 1], gamma 2.2, round to 8 bits.
//!
//! Source: Kevin Beason, smallpt, `toInt(x) = int(pow(clamp(x), 1/2.2) * 255 + .5)`. Powers come from `libm`, so the
//! bytes of a picture are the same on every platform. A NaN has no display value. A cast to an integer would silently
//! make it black, so it is refused before.

use crate::error::{Error, Result};

use super::Image;

/// The exponent between display values and linear ones.
pub const GAMMA: f64 = 2.2;

/// Converts a linear value to a display value in [0, 1]; NaN stays NaN.
pub fn display(linear: f64) -> f64 {
    libm::pow(linear.clamp(0.0, 1.0), 1.0 / GAMMA)
}

/// Converts a display value in [0, 1] to a linear one: the inverse of [`display`] within the clamp.
pub fn linear(display: f64) -> f64 {
    libm::pow(display, GAMMA)
}

/// Converts an sRGB value in [0, 1] to a linear one (IEC 61966-2-1).
#[cfg(feature = "pictures")]
pub(super) fn srgb_linear(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

/// Converts a linear value to a display value in 8 bits; `None` for NaN.
pub fn quantise(linear: f64) -> Option<u8> {
    // Truncation of v + 1/2 rounds to the nearest step, as the source does.
    (!linear.is_nan()).then(|| (display(linear) * 255.0 + 0.5) as u8)
}

/// Converts all pixels to 8 bits per channel. The error names the first pixel that is NaN.
pub fn quantise_image(image: &Image) -> Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(image.pixels.len() * 3);
    for (index, pixel) in image.pixels.iter().enumerate() {
        for &value in pixel {
            bytes.push(quantise(value).ok_or_else(|| bad_pixel(image, index, "has no colour to display"))?);
        }
    }
    Ok(bytes)
}

pub(super) fn bad_pixel(image: &Image, index: usize, problem: &str) -> Error {
    let (width, [r, g, b]) = (image.width as usize, image.pixels[index]);
    Error::Check(format!("pixel ({}, {}) = ({r}, {g}, {b}) {problem}", index % width, index / width))
}
