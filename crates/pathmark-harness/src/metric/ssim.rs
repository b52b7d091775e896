//! Structural similarity.
//!
//! Source: Wang, Bovik, Sheikh and Simoncelli, "Image quality assessment: from error visibility to structural similarity", 2004:
//! local means, variances and covariance under a Gaussian window of 11 x 11 pixels with standard deviation 1.5, K1 = 0.01,
//! K2 = 0.03, and the mean over all places where the whole window lies in the picture. Their dynamic range L is 1 here, since
//! the pictures are the luma of display values in [0, 1].

use super::separable::{Kernel, convolve};
use crate::image_io::{Image, tone_map};

const WINDOW: usize = 11;
const RADIUS: usize = WINDOW / 2;
const SIGMA: f64 = 1.5;
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;
/// Luma of gamma-coded red, green and blue: ITU-R BT.601.
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];

pub(super) fn ssim(test: &Image, reference: &Image) -> f64 {
    let (width, height) = (test.width as usize, test.height as usize);
    if width < WINDOW || height < WINDOW {
        return f64::NAN;
    }
    let (x, y) = (luma(test), luma(reference));
    let local_mean = |a: &[f64], b: &[f64]| {
        let product: Vec<f64> = a.iter().zip(b).map(|(a, b)| a * b).collect();
        blur(&product, width)
    };
    let ones = vec![1.0; x.len()];
    let (mean_x, mean_y) = (local_mean(&x, &ones), local_mean(&y, &ones));
    let (mean_xx, mean_yy, mean_xy) = (local_mean(&x, &x), local_mean(&y, &y), local_mean(&x, &y));
    let similarity = |i: usize| {
        let (mx, my) = (mean_x[i], mean_y[i]);
        let (var_x, var_y, cov) = (mean_xx[i] - mx * mx, mean_yy[i] - my * my, mean_xy[i] - mx * my);
        (2.0 * mx * my + C1) * (2.0 * cov + C2) / ((mx * mx + my * my + C1) * (var_x + var_y + C2))
    };
    (0..mean_x.len()).map(similarity).sum::<f64>() / mean_x.len() as f64
}

fn luma(image: &Image) -> Vec<f64> {
    let of = |pixel: &[f64; 3]| LUMA.iter().zip(pixel).map(|(weight, &value)| weight * tone_map::display(value)).sum();
    image.pixels.iter().map(of).collect()
}

/// Returns the weighted mean around every pixel where the window fits: smaller by `WINDOW - 1` in both directions.
fn blur(values: &[f64], width: usize) -> Vec<f64> {
    let bell = |x: f64| libm::exp(-0.5 * (x / SIGMA) * (x / SIGMA));
    let sum = Kernel::new(RADIUS, bell).sum();
    let window = Kernel::new(RADIUS, |x| bell(x) / sum);
    let means = convolve(values, width, &window, &window);
    let rows = means.chunks_exact(width).skip(RADIUS).take(values.len() / width + 1 - WINDOW);
    rows.flat_map(|row| &row[RADIUS..width - RADIUS]).copied().collect()
}
