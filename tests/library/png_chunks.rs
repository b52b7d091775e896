//! PNG files whose chunks say how their values become linear.

use super::image_io::{crc, decoded, encoded, refusal, same};
use pathmark::image_io::{Image, tone_map};

/// A PNG of one pixel with all its chunks before the pixels.
fn png_with(chunks: &[(&[u8; 4], &[u8])], pixel: [u8; 3]) -> Vec<u8> {
    let mut image = Image::new(1, 1);
    image.pixels[0] = pixel.map(|value| tone_map::linear(f64::from(value) / 255.0));
    let mut bytes = encoded("png", &image);
    // Behind the signature of 8 bytes and the header chunk of 25.
    let more = chunks.iter().flat_map(|(name, data)| {
        let body = [&name[..], data].concat();
        [&(data.len() as u32).to_be_bytes()[..], &body, &crc(&body).to_be_bytes()].concat()
    });
    bytes.splice(33..33, more.collect::<Vec<_>>());
    bytes
}

fn words(values: &[u32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_be_bytes()).collect()
}

/// The order of precedence is the one of the PNG specification (third edition, 4.3): cICP, iCCP, sRGB, gAMA.
#[test]
fn png_values_are_linear_as_its_chunks_say() {
    let gamma = |value: u32| words(&[value]);
    let primaries = |red: u32| words(&[31270, 32900, red, 33000, 30000, 60000, 15000, 6000]);
    let (own, wide) = (primaries(64000), primaries(68000));
    let pixel = [0, 64, 255];
    let read = |chunks: &[(&[u8; 4], &[u8])]| decoded("png", &png_with(chunks, pixel)).unwrap().pixels[0];
    let value: f64 = 64.0 / 255.0;
    let usual = [0.0, tone_map::linear(value), 1.0];
    // IEC 61966-2-1, whose curve is a line below 0.04045.
    let srgb = [0.0, libm::pow((value + 0.055) / 1.055, 2.4), 1.0];
    let near = |found: [f64; 3], expected: [f64; 3]| {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} is not {expected:?}");
    };
    same(read(&[]), usual);
    near(read(&[(b"gAMA", &gamma(100_000))]), [0.0, value, 1.0]);
    near(read(&[(b"gAMA", &gamma(50_000))]), [0.0, value * value, 1.0]);
    near(read(&[(b"gAMA", &gamma(200_000))]), [0.0, value.sqrt(), 1.0]);
    // 1 / 2.2, and a gamma without a meaning.
    same(read(&[(b"gAMA", &gamma(45455))]), usual);
    same(read(&[(b"gAMA", &gamma(0))]), usual);
    same(read(&[(b"cHRM", &own)]), usual);
    near(read(&[(b"sRGB", &[0])]), srgb);
    near(read(&[(b"gAMA", &gamma(100_000)), (b"cHRM", &wide), (b"sRGB", &[1])]), srgb);
    near(read(&[(b"cICP", &[1, 13, 0, 1]), (b"gAMA", &gamma(100_000))]), srgb);
    let dark = decoded("png", &png_with(&[(b"sRGB", &[0])], [5, 10, 11])).unwrap().pixels[0];
    near(dark, [5.0 / 255.0 / 12.92, 10.0 / 255.0 / 12.92, libm::pow((11.0 / 255.0 + 0.055) / 1.055, 2.4)]);
    for (chunks, said) in [
        (&[(b"cHRM", &wide[..])][..], "cHRM"),
        (&[(b"cICP", &[9, 16, 0, 1])], "cICP"),
        (&[(b"cICP", &[1, 13, 0, 0])], "cICP"),
    ] {
        assert!(refusal("png", &png_with(chunks, pixel)).contains(said), "{said}");
    }
}

/// A profile is compressed; its description names it, as ASCII or as UTF-16.
#[test]
fn a_png_with_another_colour_profile_is_refused() {
    let with = |profile: &[u8]| {
        let mut bytes = Vec::new();
        let mut info = png::Info::with_size(1, 1);
        info.color_type = png::ColorType::Rgb;
        info.icc_profile = Some(profile.to_vec().into());
        let mut writer = png::Encoder::with_info(&mut bytes, info).unwrap().write_header().unwrap();
        writer.write_image_data(&[0, 64, 255]).unwrap();
        writer.finish().unwrap();
        bytes
    };
    let srgb = decoded("png", &png_with(&[(b"sRGB", &[0])], [0, 64, 255])).unwrap().pixels[0];
    for name in [&b"desc sRGB IEC61966-2.1"[..], b"\0s\0R\0G\0B"] {
        same(decoded("png", &with(name)).unwrap().pixels[0], srgb);
    }
    assert!(refusal("png", &with(b"desc Adobe RGB (1998)")).contains("iCCP"));
}
