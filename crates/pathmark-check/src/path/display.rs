//! Conversion of radiance to displayed values.

use crate::Trials;
use crate::error::Error;
use crate::image_io::{self, FORMATS, Image, auto_exposed, tone_map};

/// An image of values in [0, 1].
fn ramp() -> Image {
    let mut image = Image::new(16, 9);
    for (index, pixel) in image.pixels.iter_mut().enumerate() {
        *pixel = [0.0, 0.3, 0.7].map(|phase| libm::fmod(phase + index as f64 * 0.037, 1.0));
    }
    image
}

/// Report C divides by the largest value of the image, so one sample darkens all pixels. Here the user must ask for
/// this, and it changes a copy only.
pub(super) fn firefly(trials: &mut Trials) {
    const AT: usize = 77;
    let plain = ramp();
    let mut bright = plain.clone();
    bright.pixels[AT] = [1e9, 0.5, 3.0];
    let folder = tempfile::tempdir().expect("a temporary folder");
    for format in FORMATS {
        let path = folder.path().join(format!("picture.{}", format.name));
        let written = |image: &Image| {
            image_io::write(&path, image).expect("a written picture");
            image_io::read(&path).expect("a readable picture").pixels
        };
        let (before, after) = (written(&plain), written(&bright));
        let changed: Vec<usize> = (0..before.len()).filter(|index| before[*index] != after[*index]).collect();
        trials.same(format!("{}: changed pixels", format.name), vec![AT], changed);
    }
    let original = bright.clone();
    let exposed = auto_exposed(&bright, bright.brightest());
    trials.same("automatic exposure leaves the picture alone", true, bright == original);
    let darkened = exposed.pixels.iter().zip(&bright.pixels).filter(|(a, b)| a[1] < 1e-8 && b[1] > 0.1).count();
    trials.holds("automatic exposure", "more than 100 of 144 pixels darkened", darkened, darkened > 100);
}

/// The byte changes at the linear value that displays as (k + 1/2)/255. Values outside the range are clamped. NaN is
/// refused and leaves no file.
pub(super) fn rounding(trials: &mut Trials) {
    let up = f64::from_bits(1.0_f64.to_bits() + 1);
    for (linear, expected) in [
        (-0.0, Some(0)),
        (0.0, Some(0)),
        (-1.0, Some(0)),
        (f64::NEG_INFINITY, Some(0)),
        (5e-324, Some(0)),
        (1.0, Some(255)),
        (up, Some(255)),
        (f64::MAX, Some(255)),
        (f64::INFINITY, Some(255)),
        (f64::NAN, None),
    ] {
        trials.same(format!("{linear:?}"), expected, tone_map::quantise(linear));
    }
    let (mut wrong, mut edges) = (0, 0);
    for k in 0..255_u8 {
        let edge = libm::pow((f64::from(k) + 0.5) / 255.0, 2.2);
        for (linear, byte) in [(edge * (1.0 - 1e-12), k), (edge * (1.0 + 1e-12), k + 1)] {
            wrong += u64::from(tone_map::quantise(linear) != Some(byte));
            edges += 1;
        }
    }
    trials.never("either side of each edge", "other bytes", wrong, edges);

    let mut image = ramp();
    image.pixels[16 * 4 + 3][1] = f64::NAN;
    let folder = tempfile::tempdir().expect("a temporary folder");
    for format in ["png", "ppm", "bmp"] {
        let path = folder.path().join(format!("picture.{format}"));
        let refusal = image_io::write(&path, &image);
        let is_named = matches!(&refusal, Err(Error::Check(text)) if text.contains("(3, 4)"));
        let found = format!("{refusal:?}, a file: {}", path.exists());
        trials.holds(
            format!("no number in {format}"),
            "pixel (3, 4) named, no file",
            found,
            is_named && !path.exists(),
        );
    }
}
