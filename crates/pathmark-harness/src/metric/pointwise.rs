//! Pointwise metrics: means over all channels of all pixels, and percentiles of the pixel error. NaN for pictures without
//! pixels.

use crate::image_io::{Image, tone_map};

/// Keeps black pixels of the reference from dominating the relative error. In squared radiance. It is fixed, since
/// errors are comparable only for one value.
pub const REL_MSE_EPSILON: f64 = 0.01;

/// The mean of `f(test, reference)` over channels and pixels, summed in their order.
fn mean(test: &Image, reference: &Image, f: impl Fn(f64, f64) -> f64) -> f64 {
    let values = test.pixels.iter().flatten().zip(reference.pixels.iter().flatten());
    values.map(|(&t, &r)| f(t, r)).sum::<f64>() / (3 * test.pixels.len()) as f64
}

pub(super) fn mse_display(test: &Image, reference: &Image) -> f64 {
    mean(test, reference, |t, r| {
        let d = tone_map::display(t) - tone_map::display(r);
        d * d
    })
}

pub(super) fn mse(test: &Image, reference: &Image) -> f64 {
    mean(test, reference, |t, r| (t - r) * (t - r))
}

/// The relative MSE of Rousselle, Knaus and Zwicker, "Adaptive sampling and reconstruction using greedy error minimization",
/// 2011: the same noise counts more in the dark, as it does for an eye.
pub(super) fn rel_mse(test: &Image, reference: &Image) -> f64 {
    mean(test, reference, |t, r| (t - r) * (t - r) / (r * r + REL_MSE_EPSILON))
}

pub(super) fn mae(test: &Image, reference: &Image) -> f64 {
    mean(test, reference, |t, r| (t - r).abs())
}

/// Peak signal-to-noise ratio in dB of display values, whose peak is 1; linear radiance has no peak. Infinite for equal
/// pictures.
pub(super) fn psnr(test: &Image, reference: &Image) -> f64 {
    -10.0 * libm::log10(mse_display(test, reference))
}

/// The error of each pixel: the root of the mean over channels of the squared difference in linear radiance.
pub(super) fn errors(test: &Image, reference: &Image) -> Vec<f64> {
    let error = |(t, r): (&[f64; 3], &[f64; 3])| {
        let squares: f64 = t.iter().zip(r).map(|(t, r)| (t - r) * (t - r)).sum();
        (squares / 3.0).sqrt()
    };
    test.pixels.iter().zip(&reference.pixels).map(error).collect()
}

/// Returns the smallest error that at least this share of the pixels does not exceed; NaN without pixels. Unlike a mean,
/// it shows how the error is distributed over pixels. A few fireflies affect only the highest percentiles, and so do a few
/// pixels that are not finite: an error that is NaN counts as larger than any number.
pub(super) fn percentile(share: f64, test: &Image, reference: &Image) -> f64 {
    let mut errors = errors(test, reference);
    if errors.is_empty() {
        return f64::NAN;
    }
    errors.sort_by(|a, b| a.is_nan().cmp(&b.is_nan()).then(a.total_cmp(b)));
    let rank = (share * errors.len() as f64).ceil() as usize;
    errors[rank.clamp(1, errors.len()) - 1]
}
