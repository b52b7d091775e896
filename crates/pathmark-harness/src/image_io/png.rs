//! PNG: display values in 8 bits per channel, lossless. Any depth is read.
//!
//! The chunks `cICP`, `iCCP`, `sRGB` and `gAMA` say how display values become linear, in this order of precedence (W3C,
//! "Portable Network Graphics Specification", third edition, 2025, 4.3). Without them the program's own gamma applies.
//! Pictures in other primaries than those of sRGB are refused.

use std::io::Cursor;

use image::codecs::png::PngDecoder;

use super::codec;
use super::{Decoded, Format, Image, Note, tone_map};
use crate::error::{InputError, Result};

pub(super) const FORMAT: Format =
    Format { notes, ..Format::new("png", "display values, 8 bits, compressed, with notes", false, decode, encode) };

/// The chunk that ends a PNG: length 0, its name, its checksum.
const END: [u8; 12] = *b"\0\0\0\0IEND\xAE\x42\x60\x82";

fn decode(bytes: &[u8]) -> Decoded<Image> {
    // The decoder stops after the last row. Without this check, a file that is cut off or continued after that row
    // would pass.
    if !bytes.ends_with(&END) {
        return Err("it does not end with the end chunk of a PNG".into());
    }
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), codec::limits()).map_err(|e| e.to_string())?;
    let linear = curve(bytes)?;
    codec::from_display(codec::decode(decoder, bytes.len())?, linear)
}

const SCALE: f64 = 1e5;
/// The gamma of a display of gamma 2.2, as a chunk can store it.
const USUAL: u32 = 45455;
/// White, red, green and blue of sRGB.
const PRIMARIES: [[f64; 2]; 4] = [[0.3127, 0.3290], [0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];
/// The difference of coordinates that does not matter.
const SAME_PRIMARY: f64 = 0.002;

type Curve = Box<dyn Fn(f64) -> f64>;

fn curve(bytes: &[u8]) -> Decoded<Curve> {
    let srgb: Decoded<Curve> = Ok(Box::new(tone_map::srgb_linear));
    let reader = header(bytes).map_err(|e| e.to_string())?;
    let info = reader.info();
    if let Some(code) = info.coding_independent_code_points {
        // Primaries and transfer function of sRGB in ITU-T H.273.
        let is_srgb = (code.color_primaries, code.transfer_function) == (1, 13) && code.is_video_full_range_image;
        return if is_srgb { srgb } else { Err("its colours (chunk cICP) are not those of sRGB".into()) };
    }
    if let Some(profile) = &info.icc_profile {
        // A profile's description is ASCII in version 2 and UTF-16 in version 4.
        let has = |name: &[u8]| profile.windows(name.len()).any(|part| part == name);
        let is_srgb = has(b"sRGB") || has(b"s\0R\0G\0B");
        return if is_srgb { srgb } else { Err("its colour profile (chunk iCCP) is not sRGB".into()) };
    }
    if info.srgb.is_some() {
        return srgb;
    }
    if let Some(found) = info.chrm_chunk {
        let found = [found.white, found.red, found.green, found.blue];
        let differs = |(found, own): (&(png::ScaledFloat, png::ScaledFloat), &[f64; 2])| {
            let found = [found.0, found.1].map(|x| f64::from(x.into_scaled()) / SCALE);
            found.iter().zip(own).any(|(x, own)| (x - own).abs() > SAME_PRIMARY)
        };
        if found.iter().zip(&PRIMARIES).any(differs) {
            return Err("its primaries (chunk cHRM) are not those of sRGB".into());
        }
    }
    Ok(match info.gama_chunk.map(png::ScaledFloat::into_scaled) {
        // A gamma of 0 has no meaning, and the specification asks to ignore it.
        None | Some(0 | USUAL) => Box::new(tone_map::linear),
        Some(gamma) => Box::new(move |value| libm::pow(value, SCALE / f64::from(gamma))),
    })
}

fn header(bytes: &[u8]) -> std::result::Result<png::Reader<Cursor<&[u8]>>, png::DecodingError> {
    let limits = png::Limits { bytes: codec::MAX_METADATA as usize };
    png::Decoder::new_with_limits(Cursor::new(bytes), limits).read_info()
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
    let Ok(reader) = header(bytes) else { return Vec::new() };
    let note = |chunk: &png::text_metadata::ITXtChunk| Some((chunk.keyword.clone(), chunk.get_text().ok()?));
    reader.info().utf8_text.iter().filter(|chunk| !chunk.compressed).filter_map(note).collect()
}
