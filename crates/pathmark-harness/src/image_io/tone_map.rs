//! Tone mapping from linear radiance to display values, as in smallpt: clamp to [0, 1], gamma 2.2, round to 8 bits.
//!
//! Source: Kevin Beason, smallpt, `toInt(x) = int(pow(clamp(x), 1/2.2) * 255 + .5)`. Powers come from `libm`, so the
//! bytes of a picture are the same on every platform. A NaN has no display value. A cast to an integer would silently
//! make it black, so it is refused before.

use super::Image;
use crate::error::{Error, Result};

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
pub(crate) fn srgb_linear(value: f64) -> f64 {
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

/// Returns the picture divided by its brightest channel ([`Image::brightest`]), as in report C; unchanged if that is not
/// above zero. It is for viewing only, not for measuring: one bright pixel darkens all others, so the values of two exposed
/// pictures are not comparable.
#[must_use]
pub fn auto_exposed(image: &Image, brightest: f64) -> Image {
    if brightest <= 0.0 {
        return image.clone();
    }
    // Divided, not multiplied by the inverse: the largest value must become exactly 1, even if its inverse is infinite.
    Image { pixels: image.pixels.iter().map(|pixel| pixel.map(|value| value / brightest)).collect(), ..*image }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(values: &[f64]) -> Image {
        let pixels: Vec<_> = values.iter().map(|value| [*value, 0.0, 0.25]).collect();
        Image { width: values.len() as u32, height: 1, pixels }
    }

    #[test]
    fn the_largest_channel_becomes_one() {
        let auto_exposed = |image: &Image| auto_exposed(image, image.brightest());
        assert_eq!(auto_exposed(&row(&[4.0, 1.0])).pixels, [[1.0, 0.0, 0.0625], [0.25, 0.0, 0.0625]]);
        // Dark pictures are brightened.
        assert_eq!(auto_exposed(&row(&[0.125])).pixels, [[0.5, 0.0, 1.0]]);
        for value in [0.1, 0.3, 7.0, 1e300] {
            assert_eq!(auto_exposed(&row(&[value, 0.01])).pixels.iter().flatten().copied().fold(0.0, f64::max), 1.0);
        }
    }

    #[test]
    fn images_without_a_largest_value_stay() {
        let auto_exposed = |image: &Image| auto_exposed(image, image.brightest());
        assert_eq!(auto_exposed(&Image::new(3, 2)), Image::new(3, 2));
        let tiny = Image { width: 1, height: 1, pixels: vec![[5e-324, 0.0, 0.0]] };
        assert_eq!(auto_exposed(&tiny).pixels, [[1.0, 0.0, 0.0]]);
        let odd = Image { width: 1, height: 1, pixels: vec![[f64::INFINITY, 2.0, f64::NAN]] };
        let [infinite, largest, nan] = auto_exposed(&odd).pixels[0];
        assert!(infinite == f64::INFINITY && largest == 1.0 && nan.is_nan());
    }
}
