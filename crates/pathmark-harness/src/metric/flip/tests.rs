use super::*;

fn of(width: u32, height: u32, pixel: impl Fn(i64, i64) -> [i64; 3]) -> Image {
    let places = (0..i64::from(height)).flat_map(|y| (0..i64::from(width)).map(move |x| (x, y)));
    let linear = |v: i64| tone_map::linear(v.clamp(0, 255) as f64 / 255.0);
    Image { width, height, pixels: places.map(|(x, y)| pixel(x, y).map(linear)).collect() }
}

/// An image with added noise from a linear congruential generator, three random numbers per pixel, row by row.
fn noisy(width: u32, height: u32, pixel: impl Fn(i64, i64) -> [i64; 3]) -> Image {
    let mut state: i64 = 1;
    let mut step = || {
        state = (state * 1_103_515_245 + 12_345) & 0x7fff_ffff;
        (state >> 16) % 64 - 32
    };
    let noise: Vec<[i64; 3]> = (0..width * height).map(|_| [step(), step(), step()]).collect();
    of(width, height, |x, y| {
        let (base, noise) = (pixel(x, y), noise[(y * i64::from(width) + x) as usize]);
        std::array::from_fn(|i| (base[i] + noise[i]).clamp(0, 255))
    })
}

fn ramp(x: i64, y: i64) -> [i64; 3] {
    [(40 + 4 * x) % 256, (200 - 5 * y) % 256, x * y % 256]
}

fn edge(at: i64) -> Image {
    of(40, 30, |x, _| [if x < at { 30 } else { 220 }; 3])
}

/// Name, reference, test, the mean, and the pixels at the first place, in the middle and in the last column of the
/// upper third. `flip-evaluator` 1.7 (the authors' own code, from `PyPI`, in single precision) gives these values for
/// the same 8-bit input.
fn cases() -> Vec<(&'static str, Image, Image, f64, [f64; 3])> {
    let grey = |v: i64| of(16, 12, move |_, _| [v; 3]);
    let point = |v: i64| of(33, 33, move |x, y| [if (x, y) == (16, 16) { v } else { 128 }; 3]);
    let colour = |rgb: [i64; 3]| of(16, 12, move |_, _| rgb);
    let small = |swap: bool| of(5, 4, move |x, y| if swap { [20 * y, 10 * x, 90] } else { [10 * x, 20 * y, 50] });
    vec![
        ("equal", of(40, 30, ramp), of(40, 30, ramp), 0.0, [0.0; 3]),
        ("edge", edge(20), edge(23), 0.146_691_784, [0.0, 0.972_348, 0.0]),
        ("grey", grey(100), grey(110), 0.153_475_210, [0.153_475; 3]),
        ("point", point(128), point(255), 0.003_949_449, [0.0, 0.378_678, 0.0]),
        ("colour", colour([0, 255, 0]), colour([0, 0, 255]), 1.0, [1.0; 3]),
        ("noise", of(40, 30, ramp), noisy(40, 30, ramp), 0.139_944_613, [0.408_468, 0.111_726, 0.200_805]),
        ("small", small(false), small(true), 0.314_386_874, [0.267_295, 0.286_638, 0.318_179]),
    ]
}

/// The error of single precision, which a root of a small difference of features magnifies.
const TOLERANCE: f64 = 2e-4;

#[test]
fn values_are_those_of_the_authors_own_program() {
    for (name, reference, test, mean, pixels) in cases() {
        assert!((flip(&test, &reference) - mean).abs() < TOLERANCE, "{name}: {}", flip(&test, &reference));
        let (width, height) = (test.width as usize, test.height as usize);
        let map = differences(&test, &reference);
        for ((x, y), expected) in [(0, 0), (width / 2, height / 2), (width - 1, height / 3)].into_iter().zip(pixels) {
            let value = map[y * width + x];
            assert!((value - expected).abs() < TOLERANCE, "{name} at {x}, {y}: {value}");
        }
    }
}

#[test]
fn a_nan_stays_in_sight() {
    let reference = of(16, 12, ramp);
    let mut test = reference.clone();
    test.pixels[100][1] = f64::NAN;
    assert!(flip(&test, &reference).is_nan());
    assert!(flip(&reference, &test).is_nan());
}
