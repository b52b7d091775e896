//! Counts of pixels within a tolerance, and of pixels that are far too bright, against the mean of two half-references.
//!
//! The noise of the reference affects both counts, so a reference needs many more samples than the picture.

use super::check_sizes;
use crate::error::Result;
use crate::image_io::{Image, tone_map};

/// Counts pixels for which `is_wanted(test, reference)` holds.
fn count(test: &Image, halves: [&Image; 2], is_wanted: impl Fn([f64; 3], [f64; 3]) -> bool) -> Result<usize> {
    halves.into_iter().try_for_each(|half| check_sizes(test, half))?;
    let references = halves[0].pixels.iter().zip(&halves[1].pixels);
    let pairs = test.pixels.iter().zip(references);
    let means = pairs.map(|(test, (a, b))| (*test, std::array::from_fn(|k| 0.5 * (a[k] + b[k]))));
    Ok(means.filter(|(test, reference)| is_wanted(*test, *reference)).count())
}

/// Returns the share of pixels whose display value is at most `tolerance` from the reference's in every channel; NaN
/// for pictures without pixels.
pub fn share_within(test: &Image, first: &Image, second: &Image, tolerance: f64) -> Result<f64> {
    let is_near = |(t, r): (&f64, &f64)| (tone_map::display(*t) - tone_map::display(*r)).abs() <= tolerance;
    let near = count(test, [first, second], |test, reference| test.iter().zip(&reference).all(is_near))?;
    Ok(near as f64 / test.pixels.len() as f64)
}

/// Returns the number of pixels that are brighter than the reference by more than `excess` in linear radiance, in any
/// channel. With a large `excess`, these are fireflies.
pub fn brighter_pixels(test: &Image, first: &Image, second: &Image, excess: f64) -> Result<u64> {
    let is_brighter = |(t, r): (&f64, &f64)| t - r > excess;
    let bright = count(test, [first, second], |test, reference| test.iter().zip(&reference).any(is_brighter))?;
    Ok(bright as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(values: &[f64]) -> Image {
        Image { width: values.len() as u32, height: 1, pixels: values.iter().map(|value| [*value, 0.5, 0.5]).collect() }
    }

    /// The mean of the halves is 0.5 everywhere, a display value of 0.7297. Within 0.05 of it, the radiance is from
    /// 0.428 to 0.579.
    #[test]
    fn pixels_count_by_their_distance_to_the_mean_of_the_halves() {
        let (first, second) = (picture(&[0.25; 5]), picture(&[0.75; 5]));
        let test = picture(&[0.5, 0.57, 0.59, 0.42, 1.6]);
        assert_eq!(share_within(&test, &first, &second, 0.05).unwrap(), 0.4);
        assert_eq!(brighter_pixels(&test, &first, &second, 1.0).unwrap(), 1);
        assert_eq!(brighter_pixels(&test, &first, &second, 0.05).unwrap(), 3);
        assert!(share_within(&test, &picture(&[0.5; 4]), &second, 0.05).is_err());
    }
}
