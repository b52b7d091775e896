//! EXR: linear values in f32, lossless and compressed; the recommended format for results. Reads one part, not deep,
//! RGB.
//!
//! Source of the header's layout: the file layout document of openexr.com.

use std::collections::BTreeMap;
use std::io::Cursor;

use exr::prelude::{SpecificChannels, Text, Vec2, WritableImage};
use image::codecs::openexr::OpenExrDecoder;

use super::codec;
use super::{Decoded, Format, Image, Note, to_f32};
use crate::error::{InputError, Result};

pub(super) const FORMAT: Format = Format {
    notes,
    ..Format::new("exr", "linear radiance in f32, compressed, lossless, with notes", true, decode, encode)
};

/// Bits of the version field for unsupported content: deep data, several parts.
const UNSUPPORTED: u32 = 0x800 | 0x1000;

fn decode(bytes: &[u8]) -> Decoded<Image> {
    check_header(bytes).ok_or("its header is damaged, or it is a deep or multi-part file")??;
    let mut source = Cursor::new(bytes);
    let decoder = OpenExrDecoder::with_alpha_preference(&mut source, Some(false)).map_err(|e| e.to_string())?;
    let image = codec::decode(decoder, bytes.len())?;
    let rest = bytes.len() as u64 - source.position().min(bytes.len() as u64);
    if rest > 0 {
        return Err(format!("{rest} bytes follow the last pixel"));
    }
    Ok(codec::from_linear(image))
}

/// Checks the sizes of the data window, the display window and the tiles. The decoder allocates by all of them, reports
/// only the display window, and mistakes a window with swapped corners for another one. `None` for a damaged or
/// unsupported header.
fn check_header(bytes: &[u8]) -> Option<Decoded<()>> {
    let mut rest = bytes.strip_prefix(b"\x76\x2f\x31\x01")?;
    let flags = u32::from_le_bytes(*take(&mut rest)?);
    if flags & UNSUPPORTED != 0 {
        return None;
    }
    while rest.first() != Some(&0) {
        let name = text(&mut rest)?;
        let kind = text(&mut rest)?;
        let length = u32::from_le_bytes(*take(&mut rest)?) as usize;
        let value = rest.get(..length)?;
        rest = &rest[length..];
        let (words, _) = value.as_chunks::<4>();
        let claim = match (name, kind, words) {
            (b"dataWindow" | b"displayWindow", b"box2i", &[left, top, right, bottom]) => {
                let side = |low, high| i64::from(i32::from_le_bytes(high)) - i64::from(i32::from_le_bytes(low)) + 1;
                (side(left, right).max(0) as u64, side(top, bottom).max(0) as u64)
            }
            (b"tiles", b"tiledesc", &[width, height]) => {
                (u64::from(u32::from_le_bytes(width)), u64::from(u32::from_le_bytes(height)))
            }
            _ => continue,
        };
        if let Err(problem) = codec::check_claim(claim.0, claim.1, bytes.len()) {
            return Some(Err(problem));
        }
    }
    Some(Ok(()))
}

fn take<'a, const N: usize>(rest: &mut &'a [u8]) -> Option<&'a [u8; N]> {
    let (head, tail) = rest.split_first_chunk()?;
    *rest = tail;
    Some(head)
}

/// Takes the next text, which ends with a zero byte; `None` for an empty one.
fn text<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let end = rest.iter().position(|&byte| byte == 0).filter(|&end| end > 0)?;
    let head = &rest[..end];
    *rest = &rest[end + 1..];
    Some(head)
}

fn encode(image: &Image, notes: &[Note]) -> Result<Vec<u8>> {
    let samples = to_f32(image)?;
    let (pixels, _) = samples.as_chunks::<3>();
    let size = Vec2(image.width as usize, image.height as usize);
    let channels = SpecificChannels::rgb(|at: Vec2<usize>| {
        let [r, g, b] = pixels[at.flat_index_for_size(size)];
        (r, g, b)
    });
    let mut file = exr::prelude::Image::from_channels(size, channels);
    if !notes.is_empty() {
        // One attribute holds all notes, since the library writes attributes unknown to it in any order.
        let json = serde_json::to_string(&notes.iter().cloned().collect::<BTreeMap<_, _>>()).unwrap_or_default();
        // Attributes have one byte per character.
        let plain: String = json.chars().map(|letter| if letter.is_ascii() { letter } else { '?' }).collect();
        file.layer_data.attributes.comments = Text::new_or_none(plain);
    }
    let mut bytes = Cursor::new(Vec::new());
    file.write().to_buffered(&mut bytes).map_err(|e| InputError::new("image", "exr", e.to_string()))?;
    Ok(bytes.into_inner())
}

fn notes(bytes: &[u8]) -> Vec<(String, String)> {
    if !matches!(check_header(bytes), Some(Ok(()))) {
        return Vec::new();
    }
    let Ok(header) = exr::meta::MetaData::read_from_buffered(bytes, false) else { return Vec::new() };
    let comment = header.headers.first().and_then(|header| header.own_attributes.comments.as_ref());
    let notes = comment.and_then(|text| serde_json::from_str::<BTreeMap<_, _>>(&text.to_string()).ok());
    notes.into_iter().flatten().collect()
}
