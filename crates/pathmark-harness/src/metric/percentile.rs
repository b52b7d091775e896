//! Percentiles of the pixel error: unlike a mean, they show how the error is distributed over pixels.
//!
//! The error of a pixel is the root of the mean over channels of the squared difference in linear radiance, as in the
//! heat map. Half of the pixels have at most the 50 % error. A few fireflies affect only the highest percentiles, and so
//! do a few pixels that are not finite: an error that is NaN counts as larger than any number.

use crate::image_io::Image;

/// The error of each pixel, row by row.
pub(super) fn errors(test: &Image, reference: &Image) -> Vec<f64> {
    let error = |(t, r): (&[f64; 3], &[f64; 3])| {
        let squares: f64 = t.iter().zip(r).map(|(t, r)| (t - r) * (t - r)).sum();
        (squares / 3.0).sqrt()
    };
    test.pixels.iter().zip(&reference.pixels).map(error).collect()
}

/// Returns the smallest error that at least this share of the pixels does not exceed; NaN without pixels.
fn at(share: f64, test: &Image, reference: &Image) -> f64 {
    let mut errors = errors(test, reference);
    if errors.is_empty() {
        return f64::NAN;
    }
    errors.sort_by(|a, b| a.is_nan().cmp(&b.is_nan()).then(a.total_cmp(b)));
    let rank = (share * errors.len() as f64).ceil() as usize;
    errors[rank.clamp(1, errors.len()) - 1]
}

pub(super) fn half(test: &Image, reference: &Image) -> f64 {
    at(0.5, test, reference)
}

pub(super) fn nine_tenths(test: &Image, reference: &Image) -> f64 {
    at(0.9, test, reference)
}

pub(super) fn all_but_a_hundredth(test: &Image, reference: &Image) -> f64 {
    at(0.99, test, reference)
}

pub(super) fn largest(test: &Image, reference: &Image) -> f64 {
    at(1.0, test, reference)
}
