//! Convergence rates: RMSE over scramblings against samples, on logarithmic axes.

use super::{Use, keyed};
use pathmark::analysis::fit::log_log;
use pathmark::sampling::{Purpose, Sampler};

const LIGHT: Use = Use { bounce: 1, branch: 0, purpose: Purpose::Bsdf };
const FILM: Use = Use { bounce: 0, branch: 0, purpose: Purpose::Film };

/// Root mean squared error over 64 pixels after 4, 16, ... 4096 samples.
fn errors(sampler: &dyn Sampler, mean: f64, value: impl Fn(&dyn Sampler, u32, u32) -> f64) -> Vec<(f64, f64)> {
    let mut squares = [0.0; 6];
    for pixel in 0..64 {
        let mut sum = 0.0;
        let mut counts = squares.iter_mut().zip((1..).map(|k| 1_u32 << (2 * k))).peekable();
        for sample in 0..4096 {
            sum += value(sampler, pixel, sample);
            if let Some((square, count)) = counts.next_if(|(_, count)| *count == sample + 1) {
                let error = sum / f64::from(count) - mean;
                *square += error * error;
            }
        }
    }
    squares.iter().enumerate().map(|(k, square)| (f64::from(4_u32 << (2 * k)), (square / 64.0).sqrt())).collect()
}

fn slope(name: &str, mean: f64, value: impl Fn(&dyn Sampler, u32, u32) -> f64) -> f64 {
    log_log(&errors(&*keyed(name), mean, value), 0.95).unwrap().slope.value
}

/// A smooth function of one pair. Independent samples, and strata of a fixed number, have the slope -1/2; scrambled
/// nets have -3/2 (Owen, "Scrambled net variance for integrals of smooth functions", 1997).
#[test]
fn smooth_functions_of_a_pair() {
    let value = |sampler: &dyn Sampler, pixel, sample| {
        let [u, v] = sampler.pair(LIGHT.of(1, pixel, sample));
        libm::exp(u * v)
    };
    // The integral of e^(uv) over the unit square: the sum over k of 1 / (k! (k + 1)^2).
    let mean = 1.317_902_151_454_404;
    let [independent, stratified, sobol] = ["independent", "stratified", "sobol"].map(|name| slope(name, mean, value));
    assert!((-0.56..-0.44).contains(&independent), "independent: {independent}");
    assert!((-0.65..-0.44).contains(&stratified), "stratified: {stratified}");
    assert!((-1.6..-1.3).contains(&sobol), "sobol: {sobol}");
}

/// Two Gauss nodes in each sixteenth of [0, 1]: they give the mean of the function below to 1e-11.
fn nodes() -> [f64; 32] {
    let half = 0.5 / 3.0_f64.sqrt();
    std::array::from_fn(|k| ((k / 2) as f64 + 0.5 + if k % 2 == 0 { -half } else { half }) / 16.0)
}

/// Light from a small square on a plane, over a pixel with four subpixels: four numbers, of which two move the point
/// slightly. The position in the pixel and the first direction are one sequence, so their joint error falls as fast as
/// the rest.
#[test]
fn smooth_functions_of_two_pairs() {
    // The light is a quarter wide and two units above.
    let value = |sampler: &dyn Sampler, pixel, sample: u32| {
        let [x, y] = sampler.pair(FILM.of(1, pixel, sample)).map(|u| u / 40.0);
        let subpixel = [sample % 2, sample / 2 % 2].map(|side| f64::from(side) / 40.0);
        let [u, v] = sampler.pair(LIGHT.of(1, pixel, sample)).map(|u| (u - 0.5) / 4.0);
        let (x, y) = (x + subpixel[0] + u, y + subpixel[1] + v);
        1.0 / (4.0 + x * x + y * y)
    };
    let along: Vec<f64> =
        nodes().iter().flat_map(|film| nodes().map(|light| film / 20.0 + (light - 0.5) / 4.0)).collect();
    let sum: f64 = along.iter().flat_map(|x| along.iter().map(move |y| 1.0 / (4.0 + x * x + y * y))).sum();
    let mean = sum / (along.len() * along.len()) as f64;
    let [independent, sobol] = ["independent", "sobol"].map(|name| slope(name, mean, value));
    assert!((-0.56..-0.44).contains(&independent), "independent: {independent}");
    assert!(sobol < -1.1, "sobol: {sobol}");
}
