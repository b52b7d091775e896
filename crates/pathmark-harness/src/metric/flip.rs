//! FLIP: how large the difference looks to a person who flips between the two pictures on one screen, from 0 (none) to 1.
//!
//! Source: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A difference evaluator for
//! alternating images", 2020, the form for pictures of a limited range. Both pictures are blurred by the eye's contrast
//! sensitivity (section 4.1), colours are compared by the `HyAB` distance (4.2), and edges and points count more (4.3,
//! 4.4). The pictures are taken as they look on an sRGB display, seen from 0.7 m on a screen 0.7 m wide with 3840
//! pixels per row, as the authors' own tool assumes.

use std::f64::consts::{PI, SQRT_2};

use super::check_sizes;
use super::heatmap::{Heatmap, painted};
use super::separable::{Kernel, convolve};
use crate::error::Result;
use crate::image_io::{Image, tone_map};

const PIXELS_PER_DEGREE: f64 = 0.7 * (3840.0 / 0.7) * (PI / 180.0);
/// Gaussians of the contrast sensitivity for light, red-green and blue-yellow: weight and width, in degrees squared.
const SENSITIVITY: [&[(f64, f64)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
/// The widest of these Gaussians, which sets the radius of all contrast filters.
const WIDEST: f64 = 0.04;
const COLOUR_EXPONENT: f64 = 0.7;
/// Differences up to this share of the largest take [`NEAR_RANGE`] of the range of the result.
const NEAR: f64 = 0.4;
const NEAR_RANGE: f64 = 0.95;
/// Width of an edge that the eye detects best, in degrees.
const FEATURE_WIDTH: f64 = 0.082;
const FEATURE_EXPONENT: f64 = 0.5;

/// Rows: X, Y and Z of linear sRGB (IEC 61966-2-1, primaries as exact fractions, white D65).
const TO_XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];
const FROM_XYZ: [[f64; 3]; 3] = [
    [3.241_003_232_976_358_7, -1.537_398_969_488_785_5, -0.498_615_881_996_363],
    [-0.969_224_252_202_516_6, 1.875_929_983_695_176, 0.041_554_226_340_084_724],
    [0.055_639_419_851_975_444, -0.204_011_206_123_909_97, 1.057_148_977_187_533_5],
];

pub(super) fn flip(test: &Image, reference: &Image) -> f64 {
    mean(&differences(test, reference))
}

/// Returns the mean of FLIP, and FLIP of each pixel as colours. The lightest colour stands for 1, the largest possible
/// difference.
pub fn flip_map(test: &Image, reference: &Image) -> Result<(f64, Heatmap)> {
    check_sizes(test, reference)?;
    let map = differences(test, reference);
    Ok((mean(&map), painted(test, &map, 1.0)))
}

fn mean(map: &[f64]) -> f64 {
    map.iter().sum::<f64>() / map.len() as f64
}

fn differences(test: &Image, reference: &Image) -> Vec<f64> {
    let width = test.width as usize;
    let [test, reference] = [test, reference].map(opponent);
    let [seen, seen_reference] = [&test, &reference].map(|planes| seen(planes, width));
    let features = feature_difference(&test[0], &reference[0], width);
    let largest = libm::pow(hyab(hunt([0.0, 1.0, 0.0]), hunt([0.0, 0.0, 1.0])), COLOUR_EXPONENT);
    let colour = |(a, b)| redistribute(libm::pow(hyab(a, b), COLOUR_EXPONENT), largest);
    let colours = seen.into_iter().zip(seen_reference).map(colour);
    colours.zip(features).map(|(colour, feature)| libm::pow(colour, 1.0 - feature)).collect()
}

fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// Converts linear RGB to X, Y and Z, each relative to white.
fn relative_xyz(rgb: [f64; 3]) -> [f64; 3] {
    let (xyz, white) = (times(&TO_XYZ, rgb), times(&TO_XYZ, [1.0; 3]));
    std::array::from_fn(|i| xyz[i] / white[i])
}

/// Planes of light, red-green and blue-yellow (Y, Cx, Cz), in which the eye's sensitivity is known.
fn opponent(image: &Image) -> [Vec<f64>; 3] {
    let mut planes = [(); 3].map(|()| Vec::with_capacity(image.pixels.len()));
    for pixel in &image.pixels {
        let [x, y, z] = relative_xyz(pixel.map(|v| tone_map::srgb_linear(tone_map::display(v))));
        for (plane, value) in planes.iter_mut().zip([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]) {
            plane.push(value);
        }
    }
    planes
}

/// Returns the colours that remain visible at the viewing distance, in Hunt-adjusted L*, a*, b*.
fn seen(planes: &[Vec<f64>; 3], width: usize) -> Vec<[f64; 3]> {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as usize;
    let blurred: [Vec<f64>; 3] = std::array::from_fn(|channel| {
        // A sum of two Gaussians is not separable, but each of them is.
        let gaussians = SENSITIVITY[channel].iter().map(|&(weight, spread)| {
            let bell = Kernel::new(radius, |x| {
                let degrees = x / PIXELS_PER_DEGREE;
                libm::exp(-PI * PI * degrees * degrees / spread)
            });
            let total = weight * (PI / spread).sqrt() * bell.sum() * bell.sum();
            let bell = bell.scaled(1.0 / bell.sum());
            (total, convolve(&planes[channel], width, &bell, &bell))
        });
        let gaussians: Vec<(f64, Vec<f64>)> = gaussians.collect();
        let total: f64 = gaussians.iter().map(|(weight, _)| weight).sum();
        let at = |i: usize| gaussians.iter().map(|(weight, plane)| weight / total * plane[i]).sum();
        (0..planes[channel].len()).map(at).collect()
    });
    let white = times(&TO_XYZ, [1.0; 3]);
    let colour = |i: usize| {
        let y = (blurred[0][i] + 16.0) / 116.0;
        let relative = [y + blurred[1][i] / 500.0, y, y - blurred[2][i] / 200.0];
        hunt(times(&FROM_XYZ, std::array::from_fn(|k| relative[k] * white[k])).map(|v| v.clamp(0.0, 1.0)))
    };
    (0..blurred[0].len()).map(colour).collect()
}

/// CIE L*, a*, b* of linear RGB, with colours weaker in the dark (Hunt effect).
fn hunt(rgb: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let root = |t: f64| if t > DELTA * DELTA * DELTA { libm::cbrt(t) } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 };
    let [x, y, z] = relative_xyz(rgb).map(root);
    let light = 116.0 * y - 16.0;
    [light, 0.01 * light * 500.0 * (x - y), 0.01 * light * 200.0 * (y - z)]
}

/// `HyAB` distance, for colours that are far apart: the absolute difference of lightness plus the Euclidean distance of
/// the other two (Abasi, Amani Tehran and Fairchild 2020).
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + length(a[1] - b[1], a[2] - b[2])
}

fn length(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// Maps a difference to [0, 1]; small differences get most of the range.
fn redistribute(difference: f64, largest: f64) -> f64 {
    let near = NEAR * largest;
    if difference < near {
        NEAR_RANGE / near * difference
    } else {
        NEAR_RANGE + (difference - near) / (largest - near) * (1.0 - NEAR_RANGE)
    }
}

/// Returns for each pixel how much edges and points differ, from 0 to 1.
fn feature_difference(test: &[f64], reference: &[f64], width: usize) -> Vec<f64> {
    let spread = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * spread).ceil() as usize;
    let bell = |x: f64| libm::exp(-x * x / (2.0 * spread * spread));
    let across = Kernel::new(radius, bell);
    let across = across.scaled(1.0 / across.sum());
    let along = [
        Kernel::new(radius, |x| -x * bell(x)).balanced(),
        Kernel::new(radius, |x| (x * x / (spread * spread) - 1.0) * bell(x)).balanced(),
    ];
    let mut largest = vec![0.0_f64; test.len()];
    for along in along {
        let strength = |light: &[f64]| {
            let light: Vec<f64> = light.iter().map(|y| (y + 16.0) / 116.0).collect();
            let (by_x, by_y) = (convolve(&light, width, &along, &across), convolve(&light, width, &across, &along));
            by_x.into_iter().zip(by_y).map(|(x, y)| length(x, y)).collect::<Vec<f64>>()
        };
        for (largest, (a, b)) in largest.iter_mut().zip(strength(test).into_iter().zip(strength(reference))) {
            let difference = (a - b).abs();
            // Unlike `max`, keeps a NaN.
            if difference > *largest || difference.is_nan() {
                *largest = difference;
            }
        }
    }
    largest.into_iter().map(|difference| libm::pow(difference / SQRT_2, FEATURE_EXPONENT)).collect()
}

#[cfg(test)]
mod tests;
