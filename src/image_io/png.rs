//! PNG: display values in 8 bits per channel, lossless. Any depth is read; a colour profile is not applied.

use std::io::Cursor;

use image::codecs::png::PngDecoder;

use super::codec::{self, Decoded};
use super::{Format, Image, Note, tone_map};
use crate::error::{InputError, Result};

pub(super) const FORMAT: Format = Format {
    name: "png",
    about: "display values, 8 bits, compressed, with notes",
    linear: false,
    forbidden_width: None,
    decode,
    encode,
    notes,
};

/// The chunk that ends a PNG: length 0, its name, its checksum.
const END: [u8; 12] = *b"\0\0\0\0IEND\xAE\x42\x60\x82";

fn decode(bytes: &[u8]) -> Decoded<Image> {
    // The decoder stops after the last row. Without this check, a file that is cut off or continued after that row
    // would pass.
    if !bytes.ends_with(&END) {
        return Err("it does not end with the end chunk of a PNG".into());
    }
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), codec::limits()).map_err(|e| e.to_string())?;
    codec::from_display(codec::decode(decoder, bytes.len())?)
}

fn encode(image: &Image, notes: &[Note]) -> Result<Vec<u8>> {
    let pixels = tone_map::quantise_image(image)?;
    pack(image, &pixels, notes).map_err(|e| InputError::new("image", "png", e.to_string()).into())
}

/// Encodes display values as a file. Notes are chunks of UTF-8 text before the pixels.
fn pack(image: &Image, pixels: &[u8], notes: &[Note]) -> std::result::Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.width, image.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    for (name, text) in notes {
        encoder.add_itxt_chunk((*name).to_string(), text.clone())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

/// Returns the uncompressed texts before the pixels; compressed ones could expand to any size. Empty if the header
/// cannot be read.
fn notes(bytes: &[u8]) -> Vec<(String, String)> {
    let limits = png::Limits { bytes: codec::MAX_METADATA as usize };
    let Ok(reader) = png::Decoder::new_with_limits(Cursor::new(bytes), limits).read_info() else { return Vec::new() };
    let note = |chunk: &png::text_metadata::ITXtChunk| Some((chunk.keyword.clone(), chunk.get_text().ok()?));
    reader.info().utf8_text.iter().filter(|chunk| !chunk.compressed).filter_map(note).collect()
}
