//! Texts stored beside the pixels of an image.

use pathmark::image_io::{self, FORMATS, Image};

#[test]
fn png_and_exr_keep_notes_and_the_same_pixels() {
    let directory = tempfile::tempdir().unwrap();
    let mut image = Image::new(7, 5);
    image.pixels.iter_mut().enumerate().for_each(|(i, pixel)| *pixel = [i as f64 / 40.0, 0.25, 0.5]);
    let notes =
        [("Software", "Pathmark".to_string()), ("pathmark.film", "{\"scene\": \"a, b\", \"spp\": 4}".to_string())];
    for format in FORMATS {
        let [plain, noted] = ["plain", "noted"].map(|stem| directory.path().join(stem).with_extension(format.name));
        image_io::write(&plain, &image).unwrap();
        image_io::write_with_notes(&noted, &image, &notes).unwrap();
        let (pixels, found) = image_io::read_with_notes(&noted).unwrap();
        assert_eq!(pixels, image_io::read(&plain).unwrap(), "{}", format.name);
        if ["png", "exr"].contains(&format.name) {
            for (name, text) in &notes {
                assert!(found.iter().any(|(n, t)| n == name && t == text), "{}: {found:?}", format.name);
            }
        } else {
            assert!(found.is_empty(), "{}: {found:?}", format.name);
        }
    }
}

#[test]
fn letters_that_exr_cannot_hold_are_replaced() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    image_io::write_with_notes(&path, &Image::new(2, 2), &[("scene", "雪 4".to_string())]).unwrap();
    assert_eq!(image_io::read_with_notes(&path).unwrap().1, [("scene".to_string(), "? 4".to_string())]);
}

#[test]
fn files_with_notes_have_the_same_bytes_each_time() {
    let directory = tempfile::tempdir().unwrap();
    let notes = [("Software", "Pathmark".to_string()), ("a", "1".to_string()), ("b", "2".to_string())];
    for format in FORMATS {
        let bytes = ["one", "two"].map(|stem| {
            let path = directory.path().join(stem).with_extension(format.name);
            image_io::write_with_notes(&path, &Image::new(3, 2), &notes).unwrap();
            std::fs::read(path).unwrap()
        });
        assert_eq!(bytes[0], bytes[1], "{}", format.name);
    }
}
