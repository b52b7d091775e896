//! Common parts of the formats: limits that are checked before any allocation, and conversion from and to the `image`
//! crate's data.
//!
//! A header of 30 bytes can claim 2^32 x 2^32 pixels. A claim is therefore checked against fixed limits and the file's
//! length before memory is allocated. No format here packs more than `MAX_PIXELS_PER_BYTE` pixels into a byte.

use image::{DynamicImage, ImageDecoder, Limits};

use super::{Decoded, Image, MAX_SIDE, check_size};

/// Deflate expands a byte to at most 1032 bytes, each of which holds 8 pixels of one bit.
const MAX_PIXELS_PER_BYTE: u64 = 8 * 1032;
/// Most bytes that a decoder may allocate for data other than pixels.
pub(super) const MAX_METADATA: u64 = 64 << 20;

/// Like [`check_size`], and also checks that a file of `length` bytes can hold that many pixels.
pub(super) fn check_claim(width: u64, height: u64, length: usize) -> Decoded<()> {
    check_size(width, height)?;
    if width * height / MAX_PIXELS_PER_BYTE > length as u64 {
        return Err(format!("{width} x {height} pixels cannot come from a file of {length} bytes"));
    }
    Ok(())
}

pub(super) fn limits() -> Limits {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE as u32);
    limits.max_image_height = Some(MAX_SIDE as u32);
    limits.max_alloc = Some(MAX_METADATA);
    limits
}

/// Reads the pixels from a decoder that has read its header, of a file of `length` bytes.
pub(super) fn decode(decoder: impl ImageDecoder, length: usize) -> Decoded<DynamicImage> {
    let (width, height) = decoder.dimensions();
    check_claim(u64::from(width), u64::from(height), length)?;
    DynamicImage::from_decoder(decoder).map_err(|e| e.to_string())
}

/// Converts display values to a picture in linear radiance. `linear` converts a value from 0 to 1.
pub(super) fn from_display(image: DynamicImage, linear: impl Fn(f64) -> f64) -> Decoded<Image> {
    // The background of a transparent pixel is not in the file.
    if image.color().has_alpha() && image.to_rgba16().pixels().any(|pixel| pixel[3] != u16::MAX) {
        return Err("it has transparent pixels".into());
    }
    let (width, height) = (image.width(), image.height());
    let deep = image.color().bytes_per_pixel() / image.color().channel_count() > 1;
    let pixels = if deep {
        let values = image.into_rgb16();
        values.pixels().map(|pixel| pixel.0.map(|v| linear(f64::from(v) / 65535.0))).collect()
    } else {
        let table: Vec<_> = (0..=u8::MAX).map(|v| linear(f64::from(v) / 255.0)).collect();
        let values = image.into_rgb8();
        values.pixels().map(|pixel| pixel.0.map(|v| table[usize::from(v)])).collect()
    };
    Ok(Image { width, height, pixels })
}

pub(super) fn from_linear(image: DynamicImage) -> Image {
    let (width, height) = (image.width(), image.height());
    let values = image.into_rgb32f();
    Image { width, height, pixels: values.pixels().map(|pixel| pixel.0.map(f64::from)).collect() }
}
