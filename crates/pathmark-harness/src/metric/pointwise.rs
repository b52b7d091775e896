//! Pointwise metrics: means over all channels of all pixels. NaN for pictures without pixels.

use crate::image_io::{Image, tone_map};

/// Keeps black pixels of the reference from dominating the relative error. In squared radiance. It is fixed, since
/// errors are comparable only for one value.
pub const REL_MSE_EPSILON: f64 = 0.01;

/// The mean of `f(test, reference)` over channels and pixels, summed in their order.
fn mean(test: &Image, reference: &Image, f: impl Fn(f64, f64) -> f64) -> f64 {
    let values = test.pixels.iter().flatten().zip(reference.pixels.iter().flatten());
    values.map(|(&t, &r)| f(t, r)).sum::<f64>() / (3 * test.pixels.len()) as f64
}

fn mse_display(test: &Image, reference: &Image) -> f64 {
    mean(test, reference, |t, r| {
        let d = tone_map::display(t) - tone_map::display(r);
        d * d
    })
}

pub(super) fn mse(test: &Image, reference: &Image) -> f64 {
    mean(test, reference, |t, r| (t - r) * (t - r))
}

pub(super) fn rmse(test: &Image, reference: &Image) -> f64 {
    mse(test, reference).sqrt()
}

/// The relative MSE of Rousselle, Knaus and Zwicker, "Adaptive sampling and reconstruction using greedy error minimization",
/// 2011: the same noise counts more in the dark, as it does for an eye.
pub(super) fn rel_mse(test: &Image, reference: &Image) -> f64 {
    mean(test, reference, |t, r| (t - r) * (t - r) / (r * r + REL_MSE_EPSILON))
}

pub(super) fn mae(test: &Image, reference: &Image) -> f64 {
    mean(test, reference, |t, r| (t - r).abs())
}

pub(super) fn rmse_display(test: &Image, reference: &Image) -> f64 {
    mse_display(test, reference).sqrt()
}

/// Peak signal-to-noise ratio in dB of display values, whose peak is 1; linear radiance has no peak. Infinite for equal
/// pictures.
pub(super) fn psnr(test: &Image, reference: &Image) -> f64 {
    -10.0 * libm::log10(mse_display(test, reference))
}
