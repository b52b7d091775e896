//! Tests of damaged files: a small picture in each format, cut off or changed at each byte. They are decoded in memory,
//! since thousands of files would be slow on a disk.

use super::{FORMATS, Image, Note};

fn sample() -> Image {
    let mut image = Image::new(9, 4);
    for (i, value) in image.pixels.as_flattened_mut().iter_mut().enumerate() {
        *value = (i * 37 % 101) as f64 / 100.0;
    }
    image
}

fn notes() -> [Note; 2] {
    [("Software", "Pathmark".to_string()), ("scene", "{\"spp\": 4}".to_string())]
}

#[test]
fn a_file_cut_off_anywhere_or_with_more_behind_it_is_refused() {
    for format in FORMATS {
        let bytes = (format.encode)(&sample(), &notes()).unwrap();
        (format.decode)(&bytes).unwrap();
        for length in 0..bytes.len() {
            assert!((format.decode)(&bytes[..length]).is_err(), "{length} bytes of {} {}", bytes.len(), format.name);
        }
        for junk in [&b"\0"[..], b"\n", b"junk behind the last pixel"] {
            assert!((format.decode)(&[&bytes[..], junk].concat()).is_err(), "{} and {junk:?}", format.name);
        }
    }
}

#[test]
fn a_damaged_byte_never_panics() {
    for format in FORMATS {
        let bytes = (format.encode)(&sample(), &notes()).unwrap();
        for at in 0..bytes.len() {
            for value in [0, 1, 0x7f, 0x80, 0xff, bytes[at] ^ 1, b'-', b'9'] {
                let mut bytes = bytes.clone();
                bytes[at] = value;
                (format.notes)(&bytes);
                // A picture or an error, both are fine; a decoded picture must have the size that it states.
                if let Ok(image) = (format.decode)(&bytes) {
                    assert_eq!(image.pixels.len(), image.width as usize * image.height as usize, "{}", format.name);
                }
            }
        }
    }
}
