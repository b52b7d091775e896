//! PFM: linear values in f32, uncompressed; the simplest lossless format.
//!
//! Source: Paul Debevec, "PFM, portable float map". `PF` (colour) or `Pf` (grey), width and height, a scale whose sign
//! gives the byte order (negative: little-endian) and whose size multiplies the values; then rows from the bottom up.
//! The header ends with one byte of white space, so the length of the file is known exactly, and any other length is
//! refused.

use super::{Decoded, Format, Image, Note, check_size, to_f32};
use crate::error::Result;

pub(super) const FORMAT: Format =
    Format::new("pfm", "linear radiance in f32, uncompressed, lossless", true, decode, encode);

fn decode(bytes: &[u8]) -> Decoded<Image> {
    let mut rest = bytes;
    let channels = match word(&mut rest)? {
        "PF" => 3,
        "Pf" => 1,
        _ => return Err("it does not begin with PF or Pf".into()),
    };
    let width = side(&mut rest)?;
    let height = side(&mut rest)?;
    let text = word(&mut rest)?;
    let scale: f32 = text.parse().map_err(|_| format!("the scale {text} is not a number"))?;
    if !scale.is_finite() || scale == 0.0 {
        return Err(format!("the scale {text} must be finite and not 0"));
    }
    check_size(u64::from(width), u64::from(height))?;
    let (width_in_values, rows) = (width as usize * channels, height as usize);
    let expected = width_in_values * rows * size_of::<f32>();
    if rest.len() != expected {
        return Err(format!("{width} x {height} pixels take {expected} bytes, and {} follow the header", rest.len()));
    }
    let read = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let factor = f64::from(scale.abs());
    let (values, _) = rest.as_chunks();
    let pixels = values
        .chunks_exact(width_in_values)
        .rev()
        .flat_map(|row| row.chunks_exact(channels))
        .map(|pixel| [0, channels / 2, channels - 1].map(|c| f64::from(read(pixel[c])) * factor))
        .collect();
    Ok(Image { width, height, pixels })
}

/// Takes the next word of the header and the byte of white space after it.
fn word<'a>(rest: &mut &'a [u8]) -> Decoded<&'a str> {
    const LONGEST: usize = 32;
    let end = rest.iter().take(LONGEST).position(u8::is_ascii_whitespace);
    let (head, tail) = rest.split_at(end.ok_or("the header ends too early or has an overlong word")?);
    *rest = &tail[1..];
    str::from_utf8(head).map_err(|_| "the header is not text".into())
}

fn side(rest: &mut &[u8]) -> Decoded<u32> {
    let text = word(rest)?;
    text.parse().map_err(|_| format!("the size {text} is not a whole number"))
}

fn encode(image: &Image, _: &[Note]) -> Result<Vec<u8>> {
    let mut bytes = format!("PF\n{} {}\n-1.0\n", image.width, image.height).into_bytes();
    bytes.reserve_exact(image.pixels.len() * 3 * size_of::<f32>());
    for row in to_f32(image)?.chunks_exact(3 * image.width as usize).rev() {
        bytes.extend(row.iter().flat_map(|value| value.to_le_bytes()));
    }
    Ok(bytes)
}
