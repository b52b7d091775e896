//! PPM: display values in 8 bits per channel. Written as binary P6, the format of the reports' own programs; read as P6
//! or P3.

use std::io::Cursor;

use image::codecs::pnm::{PnmDecoder, PnmEncoder, PnmSubtype, SampleEncoding};
use image::{ExtendedColorType, ImageEncoder};

use super::codec;
use super::{Decoded, Format, Image, Note, tone_map};
use crate::error::{InputError, Result};

pub(super) const FORMAT: Format = Format::new("ppm", "display values, 8 bits, uncompressed", false, decode, encode);

fn decode(bytes: &[u8]) -> Decoded<Image> {
    let mut source = Cursor::new(bytes);
    let decoder = PnmDecoder::new(&mut source).map_err(|e| e.to_string())?;
    let PnmSubtype::Pixmap(encoding) = decoder.subtype() else { return Err("it is not a P6 or P3 file".into()) };
    let image = codec::decode(decoder, bytes.len())?;
    let rest = &bytes[bytes.len().min(source.position() as usize)..];
    let ends = match encoding {
        SampleEncoding::Binary => rest.is_empty(),
        SampleEncoding::Ascii => rest.iter().all(u8::is_ascii_whitespace),
    };
    if !ends {
        return Err(format!("{} bytes follow the last pixel", rest.len()));
    }
    codec::from_display(image, tone_map::linear)
}

fn encode(image: &Image, _: &[Note]) -> Result<Vec<u8>> {
    let pixels = tone_map::quantise_image(image)?;
    let mut bytes = Vec::new();
    PnmEncoder::new(&mut bytes)
        .with_subtype(PnmSubtype::Pixmap(SampleEncoding::Binary))
        .write_image(&pixels, image.width, image.height, ExtendedColorType::Rgb8)
        .map_err(|e| InputError::new("image", "ppm", e.to_string()))?;
    Ok(bytes)
}
