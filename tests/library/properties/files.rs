//! Files: written data is read back to the bit, and no text makes a parser panic.

use super::cases;
use pathmark::Lab;
use pathmark::estimator::Roulette;
use pathmark::experiment::{Definition, RecordsFile, read_records};
use pathmark::film::{Assembly, Bounds, Decomposition, Film, PixelSum, TileBuffer};
use pathmark::film_file::{FilmKey, read_film, write_film};
use pathmark::image_io::{self, FORMATS, Image, tone_map};
use pathmark::measure::{Record, SCHEMA};
use proptest::prelude::*;
use std::fs;

/// Text with characters that could break a format.
fn text() -> impl Strategy<Value = String> {
    prop_oneof!["[ -~]{0,20}", "[\"',;\\\\\n\r\t#= ]{0,8}", any::<String>()]
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>().prop_filter("a number", |x| x.is_finite()),
        prop::sample::select(&[0.0, -0.0, 1.0, 5e-324, f64::MAX, f64::MIN_POSITIVE, 0.1, 1e21, 1.0 / 3.0]),
    ]
}

fn image(most: u32) -> impl Strategy<Value = Image> {
    (1..=most, 1..=most).prop_flat_map(|(width, height)| {
        let pixel = prop::array::uniform3(any::<f32>().prop_filter("a number", |x| !x.is_nan()).prop_map(f64::from));
        let pixels = prop::collection::vec(pixel, (width * height) as usize);
        pixels.prop_map(move |pixels| Image { width, height, pixels })
    })
}

fn bits(image: &Image) -> Vec<[u64; 3]> {
    image.pixels.iter().map(|pixel| pixel.map(f64::to_bits)).collect()
}

fn film(width: u32, height: u32, seed: u64) -> Film {
    let mut tile = TileBuffer::new(Bounds { x0: 0, y0: 0, x1: width, y1: height });
    for y in 0..height {
        for (x, pixel) in tile.row_mut(y).iter_mut().enumerate() {
            let bits = |k: u64| {
                f64::from_bits(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15 ^ (u64::from(y) << 40 | (x as u64) << 8 | k)))
            };
            let value = |k: u64| if bits(k).is_nan() { 0.5 } else { bits(k) };
            *pixel = PixelSum { sum: [0, 1, 2].map(value), square: [3, 4, 5].map(value), count: 7 };
        }
    }
    let mut assembly = Assembly::new(width, height, 0..7).unwrap();
    assembly.add(&(0..7), tile);
    assembly.finish()
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn images_come_back(image in image(20)) {
        let folder = tempfile::tempdir().expect("a folder");
        for format in FORMATS {
            let path = folder.path().join(format!("image.{}", format.name));
            match (image_io::write(&path, &image), format.name) {
                (Err(error), "hdr") => prop_assert_eq!(error.exit_code(), 1),
                (written, "hdr") => prop_assert!(written.is_ok() && image_io::read(&path).is_ok()),
                (written, _) => {
                    prop_assert!(written.is_ok(), "{}: {written:?}", format.name);
                    let found = image_io::read(&path).expect("what was written");
                    prop_assert_eq!((found.width, found.height), (image.width, image.height));
                    if format.linear {
                        prop_assert_eq!(bits(&found), bits(&image), "{}", format.name);
                    } else {
                        let shown = |image: &Image| image.pixels.iter().map(|pixel| pixel.map(tone_map::quantise)).collect::<Vec<_>>();
                        prop_assert_eq!(shown(&found), shown(&image), "{}", format.name);
                    }
                }
            }
        }
    }

    #[test]
    fn films_come_back(
        (scene, sampler) in (text(), text()), (width, height) in (1..9_u32, 1..9_u32), seed in any::<u64>(),
        (max_depth, camera_rays) in any::<(Option<u16>, Option<u16>)>(),
        roulette in prop::option::of(text()), changed in prop::option::of((text(), text(), text())), precision in text(), adaptive in any::<bool>(),
        time_limit in prop::option::of(1e-3..1e3_f64),
    ) {
        let (scene_hash, estimator) = ("00ff".to_string(), "bsdf".to_string());
        let (clamp, filter, epsilon) = changed.map_or((None, None, None), |(clamp, filter, epsilon)| (Some(clamp), Some(filter), Some(epsilon)));
        let key = FilmKey {
            scene, scene_hash, estimator, sampler, seed, spp: 7, width, height, max_depth, camera_rays, roulette, clamp, filter, epsilon,
            precision, adaptive, time_limit_s: time_limit.map(Into::into),
            revision: 3,
        };
        let film = film(width, height, seed);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("half.film");
        write_film(&path, &key, &film).expect("a film that is written");
        let (found_key, found) = read_film(&path).expect("a film that was written");
        prop_assert_eq!(found_key, key);
        prop_assert_eq!(found.checksum(), film.checksum());
        prop_assert_eq!(found, film);
    }

    /// Rows with any texts and numbers are read back unchanged, also when a sweep resumes.
    #[test]
    fn records_come_back(
        rows in prop::collection::vec((text(), text(), number(), prop::option::of(number()), any::<u64>(), prop::option::of(any::<u64>())), 1..5),
    ) {
        let row = |(repetition, (words, others, a, b, seed, rays))| {
            let (experiment, cell, scene, warnings) = (others, words, "\"".to_string(), ",".to_string());
            // A makespan is above 0; other numbers may have either sign.
            let (makespan_s, rmse) = (Some(f64::abs(a)).filter(|seconds| *seconds > 0.0), b);
            Record { schema: SCHEMA, experiment, cell, scene, warnings, makespan_s, rmse, seed, rays, repetition, ..Record::default() }
        };
        let rows: Vec<Record> = (0..).zip(rows).map(row).collect();
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("records.csv");
        let mut file = RecordsFile::create(&path).expect("a new file");
        for row in &rows {
            file.append(row).expect("a row that is written");
        }
        drop(file);
        prop_assert_eq!(&read_records(&path).expect("rows that were written"), &rows);
        let (_, resumed) = RecordsFile::resume(&path).expect("rows that were written");
        prop_assert_eq!(resumed, rows);
    }
}

proptest! {
    #![proptest_config(cases(1000))]

    #[test]
    fn no_text_makes_a_parser_panic(text in text(), number in any::<i64>()) {
        for text in [text.clone(), format!("{text}:{number}"), format!("tiles:{number}x{text}"), format!("albedo:{text}")] {
            if let Ok(found) = Decomposition::parse(&text) {
                prop_assert_eq!(found.name(), &text);
            }
            if let Ok(found) = Roulette::parse(&text) {
                prop_assert_eq!(Roulette::parse(&found.to_string()).expect("its own name"), found);
            }
            let _ = Lab::built_in().strategy_named(&text);
            if let Err(error) = Definition::from_text(&Lab::built_in(), "name", "file.toml", &text) {
                prop_assert_eq!(error.exit_code(), 2);
                prop_assert!(error.to_string().contains("file.toml"), "{error}");
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(30))]

    /// Arbitrary bytes, as a scene and as every other file.
    #[test]
    fn no_bytes_make_a_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        for name in FORMATS.iter().map(|format| format!("a.{}", format.name)).chain(["a.toml".to_string(), "a.csv".to_string()]) {
            fs::write(at(&name), &bytes).expect("a file");
        }
        for format in FORMATS {
            let read = image_io::read(&at(&format!("a.{}", format.name)));
            prop_assert!(read.is_err_and(|error| error.exit_code() == 2), "{}", format.name);
        }
        prop_assert!(pathmark::scene::load(at("a.toml").to_str().expect("a text")).is_err());
        prop_assert!(read_film(&at("a.csv")).is_err_and(|error| error.exit_code() == 2));
        let _ = read_records(&at("a.csv"));
    }
}
