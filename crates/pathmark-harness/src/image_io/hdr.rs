//! Radiance HDR: linear values as three 8-bit mantissas with one exponent, within 0.4 % of the brightest channel.
//!
//! Source: Greg Ward, "Real Pixels", Graphics Gems II, 1991. An `EXPOSURE` in the header is divided out, so that values are
//! radiance again.

use std::borrow::Cow;
use std::io::Cursor;

use image::codecs::hdr::{HdrDecoder, HdrEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::codec;
use super::tone_map::bad_pixel;
use super::{Decoded, Format, Image, Note};
use crate::error::{InputError, Result};

pub(super) const FORMAT: Format = Format {
    forbidden_width: Some(UNREADABLE_WIDTH),
    ..Format::new("hdr", "linear radiance, 8 bits per channel with a shared exponent", true, decode, encode)
};

/// Values of at least this size do not fit: the exponent byte ends at 2^127.
const TOO_LARGE: f64 = 1.7e38;
/// Below this the exponent byte would underflow, so the pixel is black.
const TOO_SMALL: f64 = 1e-38;
/// The `image` crate marks rows of 8 to 32768 pixels as compressed, but its reader does not know the mark for this
/// width.
const UNREADABLE_WIDTH: u32 = 32768;

/// The first line as the `image` crate knows it, and the other one that files have.
const SIGNATURE: &[u8] = b"#?RADIANCE";
const OTHER_SIGNATURE: &[u8] = b"#?RGBE";

fn decode(bytes: &[u8]) -> Decoded<Image> {
    let bytes = match bytes.strip_prefix(OTHER_SIGNATURE) {
        Some(rest) => Cow::from([SIGNATURE, rest].concat()),
        None => Cow::from(bytes),
    };
    let mut source = Cursor::new(&*bytes);
    let decoder = HdrDecoder::new(&mut source).map_err(|e| e.to_string())?;
    let metadata = decoder.metadata();
    let exposure = f64::from(metadata.exposure.unwrap_or(1.0));
    if metadata.color_correction.is_some() || !exposure.is_normal() || exposure < 0.0 {
        return Err("its exposure or colour correction cannot be undone".into());
    }
    let mut image = codec::from_linear(codec::decode(decoder, bytes.len())?);
    let rest = bytes.len() as u64 - source.position().min(bytes.len() as u64);
    if rest > 0 {
        return Err(format!("{rest} bytes follow the last pixel"));
    }
    for value in image.pixels.iter_mut().flatten() {
        *value /= exposure;
    }
    Ok(image)
}

fn encode(image: &Image, _: &[Note]) -> Result<Vec<u8>> {
    let mut samples = Vec::with_capacity(image.pixels.len() * 12);
    for (index, &pixel) in image.pixels.iter().enumerate() {
        if !pixel.iter().all(|value| (0.0..TOO_LARGE).contains(value)) {
            return Err(bad_pixel(image, index, "does not fit in an hdr picture, which stores 0 to 1.7e38"));
        }
        // The encoder takes numbers in the byte order of this machine.
        samples.extend(round(pixel).into_iter().flat_map(f32::to_ne_bytes));
    }
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes)
        .write_image(&samples, image.width, image.height, ExtendedColorType::Rgb32F)
        .map_err(|e| InputError::new("image", "hdr", e.to_string()))?;
    Ok(bytes)
}

/// Returns the nearest colour with three 8-bit mantissas. The encoder truncates mantissas, which darkens a picture by
/// half a step, and computes the exponent with the platform's logarithm. Values that already fit are not affected by
/// either.
fn round(pixel: [f64; 3]) -> [f32; 3] {
    let brightest = pixel.into_iter().fold(0.0, f64::max);
    if brightest < TOO_SMALL {
        return [0.0; 3];
    }
    let step_below = |value: f64| libm::ldexp(1.0, libm::frexp(value).1 - 8);
    let step = step_below((brightest / step_below(brightest)).round() * step_below(brightest));
    pixel.map(|value| ((value / step).round() * step) as f32)
}
