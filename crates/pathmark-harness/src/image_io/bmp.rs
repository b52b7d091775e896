//! BMP: display values in 8 bits per channel, for programs that read no other format.

use std::io::Cursor;

use image::codecs::bmp::{BmpDecoder, BmpEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::codec;
use super::{Decoded, Format, Image, Note, tone_map};
use crate::error::{InputError, Result};

pub(super) const FORMAT: Format = Format::new("bmp", "display values, 8 bits, uncompressed", false, decode, encode);

fn decode(bytes: &[u8]) -> Decoded<Image> {
    // The file length in the header reveals both a cut and appended bytes.
    let declared = bytes.get(2..6).and_then(|field| field.try_into().ok()).map(u32::from_le_bytes);
    if declared.map(u64::from) != Some(bytes.len() as u64) {
        return Err("its length differs from the length in its header".into());
    }
    let decoder = BmpDecoder::new(Cursor::new(bytes)).map_err(|e| e.to_string())?;
    codec::from_display(codec::decode(decoder, bytes.len())?, tone_map::linear)
}

fn encode(image: &Image, _: &[Note]) -> Result<Vec<u8>> {
    let pixels = tone_map::quantise_image(image)?;
    let mut bytes = Vec::new();
    BmpEncoder::new(&mut bytes)
        .write_image(&pixels, image.width, image.height, ExtendedColorType::Rgb8)
        .map_err(|e| InputError::new("image", "bmp", e.to_string()))?;
    Ok(bytes)
}
