//! Heat maps: the difference of a picture from a reference, as colours. Near black is equal; the colours pass through
//! violet, red and orange to a pale yellow at the scale and above.
//!
//! Equal steps of error are equal steps of lightness, so the map reads the same when printed in grey, and no colour
//! shows a boundary that is not in the data. Lightness, chroma and hue are from Oklab (Bjorn Ottosson, "A perceptual
//! color space for image processing", 2020), coded for a display by the sRGB curve (IEC 61966-2-1).

use std::f64::consts::PI;

use super::{check_sizes, pointwise};
use crate::error::{InputError, Result};
use crate::image_io::{Image, tone_map};

/// The colour of an error that is NaN or infinite; no finite error has it.
const NOT_FINITE: [u8; 3] = [0, 255, 255];
/// Number of colours in a map. Neighbours differ by three steps of CIE L*, and a map compresses to three quarters of
/// the size with 256 colours.
const COLOURS: u32 = 32;
/// Share of the pixels below the end of a scale that is chosen from the data. With the largest error as the end, a few
/// fireflies would leave the rest black.
const QUANTILE: f64 = 0.99;

/// Errors as colours, ready for a display.
#[derive(Debug, Clone, PartialEq)]
pub struct Heatmap {
    pub width: u32,
    pub height: u32,
    /// Red, green, blue per pixel, row 0 at the top, as a display shows them.
    pub pixels: Vec<[u8; 3]>,
    /// The error that the lightest colour stands for, as for all larger ones: an error of linear radiance, or FLIP.
    pub scale: f64,
}

impl Heatmap {
    /// Returns the colours as a picture; an 8-bit format then contains exactly these bytes.
    pub fn to_image(&self) -> Image {
        let pixels = self.pixels.iter().map(|pixel| pixel.map(|v| tone_map::linear(f64::from(v) / 255.0))).collect();
        Image { width: self.width, height: self.height, pixels }
    }
}

/// Paints the error of each pixel of `test`: the root of the mean over channels of the squared difference in linear
/// radiance. `scale` is the error of the brightest colour; give the same scale to maps that are shown side by side.
/// Without one, it is the 99th percentile of this map's errors.
pub fn heatmap(test: &Image, reference: &Image, scale: Option<f64>) -> Result<Heatmap> {
    check_sizes(test, reference)?;
    let errors = pointwise::errors(test, reference);
    let scale = scale.unwrap_or_else(|| quantile(&errors));
    if !(scale > 0.0 && scale.is_finite()) {
        return Err(InputError::new("scale", scale.to_string(), "must be positive and finite").into());
    }
    Ok(painted(test, &errors, scale))
}

/// Returns `errors` of the pixels of `image` as colours.
pub(super) fn painted(image: &Image, errors: &[f64], scale: f64) -> Heatmap {
    let last = f64::from(COLOURS - 1);
    let colours: Vec<[u8; 3]> = (0..COLOURS).map(|step| heat_colour(f64::from(step) / last)).collect();
    let paint = |error: &f64| {
        if error.is_finite() { colours[(error / scale * last).round().min(last) as usize] } else { NOT_FINITE }
    };
    Heatmap { width: image.width, height: image.height, pixels: errors.iter().map(paint).collect(), scale }
}

/// Chooses the scale from the data; 1 if there is no error.
fn quantile(errors: &[f64]) -> f64 {
    let mut finite: Vec<f64> = errors.iter().copied().filter(|error| error.is_finite()).collect();
    finite.sort_by(f64::total_cmp);
    let index = (finite.len() as f64 * QUANTILE) as usize;
    // If few pixels are wrong and the rest are exact, the quantile is 0, and the largest error is the scale.
    let candidates = [finite.get(index), finite.last()];
    candidates.into_iter().flatten().copied().find(|&error| error > 0.0).unwrap_or(1.0)
}

/// Returns the display colour for an error of `t` times the scale, `t` in [0, 1].
pub fn heat_colour(t: f64) -> [u8; 3] {
    // Chosen inside the sRGB gamut for every t, so that no channel needs clipping.
    let lightness = 0.2 + 0.77 * t;
    let chroma = 0.19 * libm::sin(PI * t);
    let hue = (280.0 + 180.0 * t).to_radians();
    let (a, b) = (chroma * libm::cos(hue), chroma * libm::sin(hue));
    let cube = |x: f64| x * x * x;
    let long = cube(lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let middle = cube(lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let short = cube(lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b);
    let linear = [
        4.076_741_662_1 * long - 3.307_711_591_3 * middle + 0.230_969_929_2 * short,
        -1.268_438_004_6 * long + 2.609_757_401_1 * middle - 0.341_319_396_5 * short,
        -0.004_196_086_3 * long - 0.703_418_614_7 * middle + 1.707_614_701_0 * short,
    ];
    linear.map(|v| {
        let coded = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * libm::pow(v, 1.0 / 2.4) - 0.055 };
        (coded * 255.0).round() as u8
    })
}
