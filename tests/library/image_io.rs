//! Image files: written images are read back, and a damaged file never causes more than an error.

use std::fs;
use std::path::{Path, PathBuf};

use pathmark::error::Error;
use pathmark::image_io::{self, FORMATS, Image, tone_map};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;
use tempfile::TempDir;

/// An image with every kind of value that each format can hold.
fn sample(width: u32, height: u32) -> Image {
    let mut random = Pcg64Mcg::new(7);
    let mut image = Image::new(width, height);
    for value in image.pixels.iter_mut().flatten() {
        *value = f64::from(random.next_u32() as f32 / u32::MAX as f32);
    }
    image.pixels[0] = [0.0, 1.0, 0.25];
    image
}

fn directory() -> TempDir {
    tempfile::tempdir().expect("a temporary directory")
}

pub(super) fn encoded(format: &str, image: &Image) -> Vec<u8> {
    let directory = directory();
    let path = directory.path().join("picture").with_extension(format);
    image_io::write(&path, image).expect("a picture that fits");
    fs::read(path).expect("the file just written")
}

/// Reads `bytes` as a file with the extension `format`.
pub(super) fn decoded(format: &str, bytes: &[u8]) -> Result<Image, Error> {
    let directory = directory();
    let path = directory.path().join("picture").with_extension(format);
    fs::write(&path, bytes).expect("a file in a temporary directory");
    image_io::read(&path)
}

/// The message of a refusal. It must be an input error, which the user can mend, and name the file.
pub(super) fn refusal(format: &str, bytes: &[u8]) -> String {
    let error = decoded(format, bytes).expect_err("a damaged file");
    assert_eq!(error.exit_code(), 2, "{error}");
    let message = error.to_string();
    assert!(message.contains(&format!("picture.{format}")), "{message}");
    message
}

/// Asserts equality to the bit.
#[track_caller]
pub(super) fn same(pixel: [f64; 3], expected: [f64; 3]) {
    assert!(pixel.map(f64::to_bits) == expected.map(f64::to_bits), "{pixel:?} is not {expected:?}");
}

#[test]
fn every_format_gives_back_the_values_it_can_hold() {
    for (width, height) in [(1, 1), (5, 3), (8, 2), (40, 21)] {
        let image = sample(width, height);
        for format in FORMATS {
            let back = decoded(format.name, &encoded(format.name, &image)).unwrap();
            if matches!(format.name, "exr" | "pfm") {
                assert_eq!(back, image, "{}: f32 values are kept to the bit", format.name);
                continue;
            }
            assert_eq!((back.width, back.height), (width, height), "{}", format.name);
            for (pixel, expected) in back.pixels.iter().zip(&image.pixels) {
                let brightest = expected.iter().copied().fold(0.0, f64::max);
                for (&value, &expected) in pixel.iter().zip(expected) {
                    if format.linear {
                        assert!((value - expected).abs() <= brightest / 255.0, "{}: {value} {expected}", format.name);
                    } else {
                        assert_eq!(tone_map::quantise(value), tone_map::quantise(expected), "{}", format.name);
                        assert!((tone_map::display(value) - tone_map::display(expected)).abs() <= 0.5001 / 255.0);
                    }
                }
            }
        }
    }
}

#[test]
fn linear_formats_keep_values_that_a_display_clips() {
    let mut image = Image::new(2, 1);
    image.pixels = vec![[1e-3, 12.5, 3000.0], [-2.0, f64::INFINITY, f64::MIN_POSITIVE]];
    for format in ["exr", "pfm"] {
        let back = decoded(format, &encoded(format, &image)).unwrap();
        same(back.pixels[0], image.pixels[0].map(|v| f64::from(v as f32)));
        same(back.pixels[1], [-2.0, f64::INFINITY, 0.0]);
    }
    image.pixels[1][0] = f64::NAN;
    assert!(decoded("exr", &encoded("exr", &image)).unwrap().pixels[1][0].is_nan());
    image.pixels[1][0] = 1e39;
    for format in ["exr", "pfm"] {
        let directory = directory();
        let error = image_io::write(&directory.path().join("a").with_extension(format), &image).unwrap_err();
        assert!(matches!(&error, Error::Check(message) if message.contains("pixel (1, 0)")), "{error}");
    }
}

#[test]
fn hdr_rounds_without_a_bias_and_over_its_whole_range() {
    let image = sample(64, 64);
    let back = decoded("hdr", &encoded("hdr", &image)).unwrap();
    let (mean, expected) = (back.mean(), image.mean());
    for (mean, expected) in mean.iter().zip(expected) {
        assert!((mean / expected - 1.0).abs() < 2e-4, "mantissas that are cut off would lose 0.2 %: {mean} {expected}");
    }
    for value in [1e-37, 3e-20, 0.999_999_9, 1.0, 255.9 / 256.0, 65504.0, 1e37, 1.6e38] {
        let mut image = Image::new(1, 1);
        image.pixels[0] = [value, value / 2.0, 0.0];
        let back = decoded("hdr", &encoded("hdr", &image)).unwrap();
        assert!((back.pixels[0][0] / value - 1.0).abs() < 0.004, "{value}: {:?}", back.pixels[0]);
    }
    // The exponent byte would wrap around, and black would become 1e37.
    let mut image = Image::new(1, 1);
    image.pixels[0] = [1e-40; 3];
    same(decoded("hdr", &encoded("hdr", &image)).unwrap().pixels[0], [0.0; 3]);
    for bad in [f64::NAN, f64::INFINITY, -1e-3, 1.8e38] {
        image.pixels[0][1] = bad;
        let directory = directory();
        let path = directory.path().join("a.hdr");
        assert!(matches!(image_io::write(&path, &image), Err(Error::Check(_))), "{bad}");
        assert!(!path.exists());
    }
}

#[test]
fn hdr_refuses_the_one_width_that_could_not_be_read_back() {
    let directory = directory();
    for (width, holds) in [(32767, true), (32768, false), (32769, true)] {
        let path = directory.path().join(format!("{width}.hdr"));
        let image = sample(width, 1);
        assert_eq!(image_io::write(&path, &image).is_ok(), holds, "{width}");
        assert_eq!(image_io::read(&path).is_ok(), holds, "{width}");
    }
}

#[test]
fn hdr_divides_the_exposure_out() {
    let image = sample(3, 2);
    let bytes = encoded("hdr", &image);
    let plain = decoded("hdr", &bytes).unwrap();
    let with = |line: &str| {
        let mut bytes = bytes.clone();
        let at = bytes.windows(6).position(|window| window == b"FORMAT").unwrap();
        bytes.splice(at..at, line.bytes());
        bytes
    };
    let bright = decoded("hdr", &with("EXPOSURE=4\n")).unwrap();
    for (bright, plain) in bright.pixels.as_flattened().iter().zip(plain.pixels.as_flattened()) {
        assert!((bright * 4.0 - plain).abs() < 1e-12);
    }
    for line in ["EXPOSURE=0\n", "EXPOSURE=nan\n", "EXPOSURE=-1\n", "EXPOSURE=x\n", "COLORCORR=1 2 1\n"] {
        refusal("hdr", &with(line));
    }
}

/// The other first line of the format, with pixels of known values: a mantissa of 128 with the exponent 129 is 1.
#[test]
fn hdr_may_begin_with_either_name() {
    let file = b"#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x40\x20\x81\x80\x80\x80\x81";
    let image = decoded("hdr", file).unwrap();
    same(image.pixels[0], [1.0, 0.5, 0.25]);
    same(image.pixels[1], [1.0; 3]);
    let radiance = encoded("hdr", &sample(9, 2));
    let other = [b"#?RGBE", radiance.strip_prefix(b"#?RADIANCE").unwrap()].concat();
    assert_eq!(decoded("hdr", &other).unwrap(), decoded("hdr", &radiance).unwrap());
    refusal("hdr", &[b"#?RGB", radiance.strip_prefix(b"#?RADIANCE").unwrap()].concat());
}

#[test]
fn a_damaged_file_is_the_users_to_mend_and_named() {
    for format in FORMATS {
        let bytes = encoded(format.name, &sample(9, 4));
        refusal(format.name, &bytes[..bytes.len() - 1]);
        refusal(format.name, &[&bytes[..], b"more"].concat());
        refusal(format.name, b"");
    }
}

#[test]
fn a_header_that_claims_too_much_is_refused_before_memory_is_asked_for() {
    let huge = ["4294967295 1", "1 4294967295", "65537 1", "65536 65536", "60000 60000", "0 5", "5 0"];
    let odd = ["-1 5", "+ 5", "5.5 5", "99999999999999999999 1", "nan 3", "", "5"];
    for size in huge.into_iter().chain(odd) {
        refusal("ppm", format!("P6\n{size}\n255\nabc").as_bytes());
        refusal("pfm", format!("PF\n{size}\n-1.0\nabcdefghijkl").as_bytes());
        let (width, height) = size.split_once(' ').unwrap_or((size, ""));
        let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n");
        refusal("hdr", &[header.as_bytes(), b"\x02\x02\0\x05abcdefgh"].concat());
    }
    assert!(refusal("pfm", b"PF\n60000 60000\n-1.0\n").contains("in all"), "sides in order, too many pixels");
    // Width and height are big-endian words behind the first chunk's name. The chunk's checksum follows the chunk.
    let png = encoded("png", &sample(5, 3));
    for side in [u32::MAX, 1 << 31, 65537, 65536, 16384] {
        let mut bytes = png.clone();
        bytes[16..20].copy_from_slice(&side.to_be_bytes());
        bytes[20..24].copy_from_slice(&side.to_be_bytes());
        let checksum = crc(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
        let message = refusal("png", &bytes);
        assert!(side > 65536 || message.contains("pixels"), "the size is the reason: {message}");
    }
    let bmp = encoded("bmp", &sample(5, 3));
    for side in [i32::MAX, i32::MIN, 65537, 65536] {
        for at in [18, 22] {
            let mut bytes = bmp.clone();
            bytes[at..at + 4].copy_from_slice(&side.to_le_bytes());
            refusal("bmp", &bytes);
        }
    }
    let exr = encoded("exr", &sample(5, 3));
    let at = exr.windows(8).position(|bytes| bytes == b"tiledesc").unwrap() + 9 + 4;
    for side in [u32::MAX, 1 << 31, 65537, 16384] {
        let mut bytes = exr.clone();
        bytes[at..at + 4].copy_from_slice(&side.to_le_bytes());
        bytes[at + 4..at + 8].copy_from_slice(&side.to_le_bytes());
        assert!(refusal("exr", &bytes).contains("pixels"), "the size is the reason");
    }
    for window in ["dataWindow", "displayWindow"] {
        let at = exr.windows(window.len()).position(|bytes| bytes == window.as_bytes()).unwrap();
        let corner = at + window.len() + 1 + "box2i\0".len() + 4 + 8;
        for (x, y) in [(i32::MAX, i32::MAX), (1 << 20, 2), (65535, 65535), (16383, 16383), (-1, -1), (i32::MIN, 0)] {
            let mut bytes = exr.clone();
            bytes[corner..corner + 4].copy_from_slice(&x.to_le_bytes());
            bytes[corner + 4..corner + 8].copy_from_slice(&y.to_le_bytes());
            assert!(refusal("exr", &bytes).contains("pixels"), "the size is the reason");
        }
    }
}

/// The checksum of PNG chunks.
pub(super) fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32, &byte: &u8| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 & 0u32.wrapping_sub(crc & 1)))
    };
    !bytes.iter().fold(u32::MAX, step)
}

#[test]
fn pfm_has_two_byte_orders_rows_from_the_bottom_and_a_scale() {
    let values: Vec<f32> = (1..=12).map(|v| v as f32 / 4.0).collect();
    let file = |header: &str, bytes: fn(f32) -> [u8; 4]| -> Vec<u8> {
        [header.as_bytes(), &values.iter().flat_map(|&v| bytes(v)).collect::<Vec<_>>()].concat()
    };
    // Two columns, two rows; the file's first row is the lower one.
    let upper_left = [1.75, 2.0, 2.25];
    for (header, bytes) in [
        ("PF\n2 2\n-1.0\n", f32::to_le_bytes as fn(f32) -> [u8; 4]),
        ("PF\n2 2\n1.0\n", f32::to_be_bytes),
        ("PF 2 2 -1\n", f32::to_le_bytes),
    ] {
        let image = decoded("pfm", &file(header, bytes)).unwrap();
        same(image.pixel(0, 0), upper_left);
        same(image.pixel(0, 1), [0.25, 0.5, 0.75]);
    }
    let doubled = decoded("pfm", &file("PF\n2 2\n-2\n", f32::to_le_bytes)).unwrap();
    same(doubled.pixel(0, 0), upper_left.map(|v| 2.0 * v));
    let grey = decoded("pfm", &file("Pf\n3 4\n-1\n", f32::to_le_bytes)).unwrap();
    same(grey.pixel(0, 0), [2.5; 3]);
    same(grey.pixel(2, 3), [0.75; 3]);
    for header in
        ["PF\n2 2\n0\n", "PF\n2 2\n-0.0\n", "PF\n2 2\nnan\n", "PF\n2 2\ninf\n", "PF\n2 2\n\n", "PF\n2 2\none\n"]
    {
        assert!(refusal("pfm", &file(header, f32::to_le_bytes)).contains("scale"), "{header:?}");
    }
    for header in
        ["PF\r\n2 2\r\n-1\r\n", "P6\n2 2\n-1\n", "PF\n2  2\n-1\n", "PF\n2 3\n-1\n", "PF\n2 1\n-1\n", "PF\n-2 2\n-1\n"]
    {
        refusal("pfm", &file(header, f32::to_le_bytes));
    }
}

#[test]
fn ppm_is_read_as_the_standard_says() {
    let pixels = b"\x00\x80\xff\x01\x02\x03";
    let grey = tone_map::linear(128.0 / 255.0);
    for header in ["P6\n2 1\n255\n", "P6 2 1 255 ", "P6\n# a comment\n2 1\n# another\n255\n", "P6\r\n2 1 255\n"] {
        let image = decoded("ppm", &[header.as_bytes(), pixels].concat()).unwrap();
        same(image.pixels[0], [0.0, grey, 1.0]);
    }
    let text = decoded("ppm", b"P3\n2 1\n255\n0 128 255  1 2 3 \n").unwrap();
    same(text.pixels[0], [0.0, grey, 1.0]);
    let deep = decoded("ppm", b"P6\n1 1\n65535\n\x00\x00\x80\x80\xff\xff").unwrap();
    same(deep.pixels[0], [0.0, tone_map::linear(f64::from(0x8080) / 65535.0), 1.0]);
    for header in
        ["P6\n2 1\n0\n", "P6\n2 1\n65536\n", "P6\n2 1\n-1\n", "P5\n2 1\n255\n", "P5\n6 1\n255\n", "P9\n2 1\n255\n"]
    {
        refusal("ppm", &[header.as_bytes(), pixels].concat());
    }
}

#[test]
fn quantisation_has_no_surprises_at_its_edges() {
    let cases = [
        (-0.0, 0),
        (0.0, 0),
        (-1.0, 0),
        (f64::NEG_INFINITY, 0),
        (f64::MIN_POSITIVE, 0),
        (1.0 - f64::EPSILON, 255),
        (1.0, 255),
        (1.0 + f64::EPSILON, 255),
        (f64::INFINITY, 255),
        // Values just above half a step round up, values just below round down.
        (tone_map::linear(0.5 / 255.0) * (1.0 - 1e-12), 0),
        (tone_map::linear(0.5 / 255.0) * (1.0 + 1e-12), 1),
        (tone_map::linear(254.5 / 255.0) * (1.0 - 1e-12), 254),
        (tone_map::linear(254.5 / 255.0) * (1.0 + 1e-12), 255),
        // (1/2)^(1/2.2) * 255 + 1/2 = 186.59
        (0.5, 186),
    ];
    for (linear, expected) in cases {
        assert_eq!(tone_map::quantise(linear), Some(expected), "{linear:e}");
    }
    assert_eq!(tone_map::quantise(f64::NAN), None);
    assert!(tone_map::display(f64::NAN).is_nan());
    for v in 0..=u8::MAX {
        assert_eq!(tone_map::quantise(tone_map::linear(f64::from(v) / 255.0)), Some(v));
    }
}

#[test]
fn a_pixel_without_a_colour_is_named_and_nothing_is_written() {
    let mut image = sample(4, 3);
    image.pixels[6][2] = f64::NAN;
    for format in FORMATS.iter().filter(|format| !format.linear) {
        let directory = directory();
        let path = directory.path().join("a").with_extension(format.name);
        fs::write(&path, "old").unwrap();
        let error = image_io::write(&path, &image).unwrap_err();
        assert!(matches!(&error, Error::Check(message) if message.contains("pixel (2, 1)")), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
    }
}

#[test]
fn the_extension_chooses_the_format() {
    assert_eq!(image_io::check_format(Path::new("a/b.c/picture.PnG")).unwrap().name, "png");
    for path in ["picture", "picture.jpg", ".png", "png", "picture.png.", "picture.png.txt"] {
        let error = image_io::check_format(Path::new(path)).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().ends_with("(allowed: png, exr, hdr, pfm, ppm, bmp)"), "{error}");
    }
}

#[test]
fn a_transparent_picture_is_refused_and_an_opaque_one_read() {
    for (alpha, readable) in [(255, true), (254, false)] {
        let directory = directory();
        let path = directory.path().join("a.png");
        let pixels = image::RgbaImage::from_raw(2, 1, vec![255, 0, 0, 255, 0, 255, 0, alpha]).unwrap();
        pixels.save(&path).unwrap();
        assert_eq!(image_io::read(&path).is_ok(), readable, "alpha {alpha}");
    }
}

#[test]
fn files_that_are_no_pictures_are_refused() {
    let directory = directory();
    let cases: [(PathBuf, u8); 3] = [
        (directory.path().join("missing.png"), 2),
        (directory.path().join("missing/picture.exr"), 2),
        (directory.path().join("folder.pfm"), 2),
    ];
    fs::create_dir(&cases[2].0).unwrap();
    for (path, code) in cases {
        assert_eq!(image_io::read(&path).unwrap_err().exit_code(), code, "{}", path.display());
    }
    let error = image_io::write(&directory.path().join("a.pfm"), &Image::new(0, 4)).unwrap_err();
    assert_eq!(error.exit_code(), 2, "{error}");
}

#[test]
fn one_picture_has_one_mean() {
    let mut image = Image::new(2, 2);
    same(image.mean(), [0.0; 3]);
    image.pixels[3] = [4.0, 2.0, 1.0];
    same(image.pixel(1, 1), [4.0, 2.0, 1.0]);
    same(image.pixel(0, 1), [0.0; 3]);
    same(image.mean(), [1.0, 0.5, 0.25]);
}
