//! Numbers in scene files: each is checked while it is read, so that an error can name its position.
//!
//! Lengths and coordinates are at most 1e100: their squares and products must stay finite in every intersection
//! formula.

use crate::math::{Rgb, Vec3};
use serde::de::{Deserialize, Deserializer, Error};

const LARGEST: f64 = 1e100;
const SMALLEST: f64 = 1e-100;

fn checked<'de, D: Deserializer<'de>>(
    deserializer: D,
    is_allowed: impl Fn(f64) -> bool,
    allowed: &str,
) -> Result<f64, D::Error> {
    let value = f64::deserialize(deserializer)?;
    if is_allowed(value) { Ok(value) } else { Err(out_of_range(value, allowed)) }
}

fn checked_triple<'de, D: Deserializer<'de>>(
    deserializer: D,
    is_allowed: impl Fn(f64) -> bool,
    allowed: &str,
) -> Result<[f64; 3], D::Error> {
    let values: [f64; 3] = array(deserializer)?;
    match values.iter().find(|value| !is_allowed(**value)) {
        None => Ok(values),
        Some(value) => Err(out_of_range(*value, allowed)),
    }
}

/// Reads exactly `N` values. The arrays of `serde` leave out those after the last, and so does `toml`.
pub fn array<'de, T: Deserialize<'de>, D: Deserializer<'de>, const N: usize>(
    deserializer: D,
) -> Result<[T; N], D::Error> {
    let values = Vec::deserialize(deserializer)?;
    let count = values.len();
    values.try_into().map_err(|_: Vec<T>| D::Error::invalid_length(count, &format!("an array of length {N}").as_str()))
}

/// Reads exactly `N` values, where a key may be left out.
pub fn optional_array<'de, T: Deserialize<'de>, D: Deserializer<'de>, const N: usize>(
    deserializer: D,
) -> Result<Option<[T; N]>, D::Error> {
    array(deserializer).map(Some)
}

/// Whether a coordinate is within bounds; false for NaN.
pub fn coordinate_limit(x: f64) -> bool {
    x.abs() <= LARGEST
}

/// Returns the error for a number outside its allowed range.
pub fn out_of_range<E: Error>(value: f64, allowed: &str) -> E {
    E::custom(format_args!("{value:?} is out of range (allowed: {allowed})"))
}

/// Reads an albedo: three shares from 0 to 1.
pub fn albedo<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Rgb, D::Error> {
    checked_triple(deserializer, |x| (0.0..=1.0).contains(&x), "0 to 1 in each channel").map(Rgb::from)
}

/// Reads three radiances of zero or more.
pub fn radiance<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Rgb, D::Error> {
    checked_triple(deserializer, |x| (0.0..=LARGEST).contains(&x), "0 to 1e100 in each channel").map(Rgb::from)
}

/// Reads a point: three coordinates.
pub fn point<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec3, D::Error> {
    checked_triple(deserializer, coordinate_limit, "-1e100 to 1e100 in each coordinate").map(Vec3::from)
}

/// Reads a direction of any length and normalises it.
pub fn direction<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec3, D::Error> {
    let d = point(deserializer)?;
    let largest = d.largest();
    if largest < SMALLEST {
        return Err(D::Error::custom("the zero vector has no direction (allowed: a length of at least 1e-100)"));
    }
    Ok((d * (1.0 / largest)).normalized())
}

/// Reads three angles in degrees.
pub fn degrees<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 3], D::Error> {
    checked_triple(deserializer, |x| (-360.0..=360.0).contains(&x), "-360 to 360 degrees in each angle")
}

/// Reads a length above zero.
pub fn length<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    checked(deserializer, |x| (SMALLEST..=LARGEST).contains(&x), "1e-100 to 1e100")
}

/// Reads a distance of zero or more.
pub fn positive<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    checked(deserializer, |x| (0.0..=LARGEST).contains(&x), "0 to 1e100")
}

/// Reads a ratio of indices of refraction.
pub fn refractive_index<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    checked(deserializer, |x| (0.01..=100.0).contains(&x), "0.01 to 100")
}

/// Reads a number from 0 to 1.
pub fn share<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    checked(deserializer, |x| (0.0..=1.0).contains(&x), "0 to 1")
}

/// Reads the roughness of a microfacet surface, GGX's alpha: 0 (smooth) or 1e-4 to 1. Below 1e-4 the lobe is narrower
/// than the rounding error of directions.
pub fn roughness<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    checked(deserializer, |x| x == 0.0 || (1e-4..=1.0).contains(&x), "0, or 1e-4 to 1")
}

/// Reads a vertical field of view in degrees; returns the height of the image plane at distance 1.
pub fn field_of_view<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let degrees = checked(deserializer, |x| (1e-6..=179.0).contains(&x), "1e-6 to 179 degrees")?;
    Ok(2.0 * libm::tan(degrees.to_radians() / 2.0))
}
