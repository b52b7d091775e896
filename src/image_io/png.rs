//! PNG: 8 bits a channel of display values, lossless. Read in any depth; a colour profile is not applied.

use std::io::Cursor;

use image::codecs::png::{PngDecoder, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::codec::{self, Decoded};
use super::{Format, Image, tone_map};
use crate::error::{InputError, Result};

pub(super) const FORMAT: Format = Format {
    name: "png",
    about: "what a display shows, 8 bits, compressed",
    linear: false,
    forbidden_width: None,
    decode,
    encode,
};

/// The chunk that ends a PNG: length 0, its name, its checksum.
const END: [u8; 12] = *b"\0\0\0\0IEND\xAE\x42\x60\x82";

fn decode(bytes: &[u8]) -> Decoded<Image> {
    // The decoder stops after the last row it needs; a file that was cut off, or goes on, behind it would pass.
    if !bytes.ends_with(&END) {
        return Err("it does not end where a PNG ends".into());
    }
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), codec::limits()).map_err(|e| e.to_string())?;
    codec::from_display(codec::decode(decoder, bytes.len())?)
}

fn encode(image: &Image) -> Result<Vec<u8>> {
    let pixels = tone_map::quantise_image(image)?;
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(&pixels, image.width, image.height, ExtendedColorType::Rgb8)
        .map_err(|e| InputError::new("image", "png", e.to_string()))?;
    Ok(bytes)
}
