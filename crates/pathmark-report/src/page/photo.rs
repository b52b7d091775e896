//! Pictures within the page: as JPEG where that is smaller, because the noise of renders does not compress without loss.
//! The PNG files beside the page are exact.

use crate::error::{Error, Result};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::codecs::jpeg::JpegEncoder;
use image::{ImageError, ImageFormat};
use std::io;

/// At this quality, the letters of captions are sharp, and noise looks as before.
const QUALITY: u8 = 70;

/// The picture of a PNG file as the source of an image element.
pub(super) fn source(png: &[u8]) -> Result<String> {
    let failed = |error: ImageError| Error::system("drawing", "a picture of the page", io::Error::other(error));
    let image = image::load_from_memory_with_format(png, ImageFormat::Png).map_err(failed)?.into_rgb8();
    let mut jpeg = Vec::new();
    JpegEncoder::new_with_quality(&mut jpeg, QUALITY).encode_image(&image).map_err(failed)?;
    let (kind, bytes) = if jpeg.len() < png.len() { ("jpeg", jpeg.as_slice()) } else { ("png", png) };
    Ok(format!("data:image/{kind};base64,{}", STANDARD.encode(bytes)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{Rgb, RgbImage};
    use std::io::Cursor;

    fn png(pixel: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        RgbImage::from_fn(64, 64, |x, y| Rgb(pixel(x, y))).write_to(&mut bytes, ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn noise_is_a_jpeg_and_flat_areas_are_a_png() {
        let noise = png(|x, y| {
            [0, 1, 2]
                .map(|channel| (x * 7919 + y * 104_729 + channel * 31).wrapping_mul(2_654_435_761).to_be_bytes()[0])
        });
        assert!(source(&noise).unwrap().starts_with("data:image/jpeg;base64,"));
        assert!(source(&png(|_, _| [255; 3])).unwrap().starts_with("data:image/png;base64,"));
        assert_eq!(source(b"text").unwrap_err().exit_code(), 3);
    }
}
